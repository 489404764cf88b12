//! What the page calls: seven exported names.
//!
//! A question is written to the memory that [`question_room`] returns: first its text (JSON), then
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
use crate::desk::Desk;

#[derive(Default)]
struct Door {
    room: Vec<u8>,
    desk: Desk,
    answer: Answer,
}

thread_local! {
    static DOOR: RefCell<Door> = RefCell::default();
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

fn with<T>(f: impl FnOnce(&mut Door) -> T) -> T {
    DOOR.with(|door| f(&mut door.borrow_mut()))
}

/// Room for a question of this many bytes.
#[unsafe(no_mangle)]
extern "C" fn question_room(bytes: usize) -> *mut u8 {
    with(|door| {
        door.room.clear();
        door.room.resize(bytes, 0);
        door.room.as_mut_ptr()
    })
}

/// Answers the question in the room: its first `text` bytes are JSON, the rest is a file.
#[unsafe(no_mangle)]
extern "C" fn ask(text: usize) {
    listen();
    with(|door| {
        let mut room = std::mem::take(&mut door.room);
        let file = room.split_off(text.min(room.len()));
        // What the last answer held is given back before the next one is made.
        door.answer = Answer::default();
        door.answer = door.desk.ask(&room, file);
    });
}

/// Where the answer's text begins.
#[unsafe(no_mangle)]
extern "C" fn text() -> *const u8 {
    with(|door| door.answer.text.as_ptr())
}

/// How long it is.
#[unsafe(no_mangle)]
extern "C" fn text_length() -> usize {
    with(|door| door.answer.text.len())
}

/// Where the answer's numbers begin.
#[unsafe(no_mangle)]
extern "C" fn numbers() -> *const u8 {
    with(|door| door.answer.numbers.as_ptr())
}

/// How many bytes they are.
#[unsafe(no_mangle)]
extern "C" fn numbers_length() -> usize {
    with(|door| door.answer.numbers.len())
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
