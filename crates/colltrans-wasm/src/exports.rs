//! The interface between the page and a module: eight exported functions.
//!
//! The page writes a question to the memory that `question_buffer` returns: its text (JSON), then the bytes
//! of a file if there is one. `ask` answers it. The answer stays valid until the next question; `text` and
//! `numbers` return the addresses of its parts, `text_length` and `numbers_length` their lengths. If the
//! library panics, which is a bug, `last_words` has the message.
//!
//! There is no unsafe block. The compiler counts the export of a name as unsafe, because two libraries could
//! export the same name. Addresses are only returned, never accepted.

use std::sync::{Mutex, Once, PoisonError};

use crate::Answers;
use crate::answer::Answer;

/// The memory that the page and a module share.
#[derive(Debug, Default)]
pub struct Exchange<S> {
    buffer: Vec<u8>,
    state: S,
    answer: Answer,
}

static LAST_WORDS: Mutex<String> = Mutex::new(String::new());
static LISTENING: Once = Once::new();

impl<S: Answers> Exchange<S> {
    /// Returns a buffer for a question with this number of bytes.
    pub fn question_buffer(&mut self, bytes: usize) -> *mut u8 {
        self.buffer.clear();
        self.buffer.resize(bytes, 0);
        self.buffer.as_mut_ptr()
    }

    /// Answers the question in the buffer. Its first `text` bytes are JSON, the rest is a file.
    pub fn ask(&mut self, text: usize) {
        LISTENING.call_once(|| {
            std::panic::set_hook(Box::new(|panic| {
                *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = panic.to_string();
            }));
        });
        let mut buffer = std::mem::take(&mut self.buffer);
        let file = buffer.split_off(text.min(buffer.len()));
        // Free the memory of the last answer before the next one is built.
        self.answer = Answer::default();
        self.answer = self.state.ask(&buffer, file);
    }

    /// Returns the answer to the last question.
    pub fn answer(&self) -> &Answer {
        &self.answer
    }
}

/// Returns the address and the length of the message of a panic.
pub fn last_words() -> (*const u8, usize) {
    let words = LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner);
    (words.as_ptr(), words.len())
}

/// Exports the functions that the page calls. Questions go to a state of the given type.
#[macro_export]
macro_rules! export {
    ($state:ty) => {
        thread_local! {
            static EXCHANGE: std::cell::RefCell<$crate::exports::Exchange<$state>> =
                std::cell::RefCell::default();
        }

        #[unsafe(no_mangle)]
        extern "C" fn question_buffer(bytes: usize) -> *mut u8 {
            EXCHANGE.with_borrow_mut(|exchange| exchange.question_buffer(bytes))
        }

        #[unsafe(no_mangle)]
        extern "C" fn ask(text: usize) {
            EXCHANGE.with_borrow_mut(|exchange| exchange.ask(text));
        }

        #[unsafe(no_mangle)]
        extern "C" fn text() -> *const u8 {
            EXCHANGE.with_borrow(|exchange| exchange.answer().text.as_ptr())
        }

        #[unsafe(no_mangle)]
        extern "C" fn text_length() -> usize {
            EXCHANGE.with_borrow(|exchange| exchange.answer().text.len())
        }

        #[unsafe(no_mangle)]
        extern "C" fn numbers() -> *const u8 {
            EXCHANGE.with_borrow(|exchange| exchange.answer().numbers.as_ptr())
        }

        #[unsafe(no_mangle)]
        extern "C" fn numbers_length() -> usize {
            EXCHANGE.with_borrow(|exchange| exchange.answer().numbers.len())
        }

        #[unsafe(no_mangle)]
        extern "C" fn last_words() -> *const u8 {
            $crate::exports::last_words().0
        }

        #[unsafe(no_mangle)]
        extern "C" fn last_words_length() -> usize {
            $crate::exports::last_words().1
        }
    };
}
