//! What the page calls: seven exported names.
//!
//! A question is written to the memory that [`question_buffer`] returns: first its text (JSON), then
//! the bytes of a file if there is one. [`ask`] answers it; text and numbers of the answer are read
//! where [`text`] and [`numbers`] say, until the next question. Each of these places is returned as
//! an address, and its length by [`text_length`] and [`numbers_length`].
//!
//! If the library stops, which it never should, the page reads why at [`last_words`].
//!
//! There is no unsafe block: exporting a name is what the compiler counts as unsafe, because two
//! libraries could export the same one. Addresses only leave, they never come in.
#![expect(unsafe_code, reason = "exported names")]

use std::cell::RefCell;
use std::sync::{Mutex, Once, PoisonError};

use crate::answer::Answer;
use crate::state::State;

#[derive(Default)]
struct Exchange {
    buffer: Vec<u8>,
    state: State,
    answer: Answer,
}

thread_local! {
    static EXCHANGE: RefCell<Exchange> = RefCell::default();
}

static LAST_WORDS: Mutex<String> = Mutex::new(String::new());
static LISTENING: Once = Once::new();

fn listen() {
    LISTENING.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = panic.to_string();
        }));
    });
}

fn with<T>(f: impl FnOnce(&mut Exchange) -> T) -> T {
    EXCHANGE.with(|exchange| f(&mut exchange.borrow_mut()))
}

/// A buffer for a question of this many bytes.
#[unsafe(no_mangle)]
extern "C" fn question_buffer(bytes: usize) -> *mut u8 {
    with(|exchange| {
        exchange.buffer.clear();
        exchange.buffer.resize(bytes, 0);
        exchange.buffer.as_mut_ptr()
    })
}

/// Answers the question in the buffer: its first `text` bytes are JSON, the rest is a file.
#[unsafe(no_mangle)]
extern "C" fn ask(text: usize) {
    listen();
    with(|exchange| {
        let mut buffer = std::mem::take(&mut exchange.buffer);
        let file = buffer.split_off(text.min(buffer.len()));
        // What the last answer held is given back before the next one is made.
        exchange.answer = Answer::default();
        exchange.answer = exchange.state.ask(&buffer, file);
    });
}

/// Where the answer's text begins.
#[unsafe(no_mangle)]
extern "C" fn text() -> *const u8 {
    with(|exchange| exchange.answer.text.as_ptr())
}

/// How long it is.
#[unsafe(no_mangle)]
extern "C" fn text_length() -> usize {
    with(|exchange| exchange.answer.text.len())
}

/// Where the answer's numbers begin.
#[unsafe(no_mangle)]
extern "C" fn numbers() -> *const u8 {
    with(|exchange| exchange.answer.numbers.as_ptr())
}

/// How many bytes they are.
#[unsafe(no_mangle)]
extern "C" fn numbers_length() -> usize {
    with(|exchange| exchange.answer.numbers.len())
}

/// Where the reason begins why the library stopped.
#[unsafe(no_mangle)]
extern "C" fn last_words() -> *const u8 {
    LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner).as_ptr()
}

/// How long it is.
#[unsafe(no_mangle)]
extern "C" fn last_words_length() -> usize {
    LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner).len()
}
