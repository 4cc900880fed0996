//! The language server: what an editor asks of a layout while it is written.
//!
//! [`serve`] speaks the Language Server Protocol 3.17 over standard input and output. One thread answers in the order in
//! which a client asks, so that each answer is of the text that the client had then; a check of a thousand lines takes
//! milliseconds. Solving takes longer, has a thread of its own and nothing waits for it.
//!
//! - [`workspace`]: open documents and their checks, with open texts in the place of files,
//! - [`server`]: messages in, answers and diagnostics out,
//! - the rest: one file for each kind of question.

mod actions;
mod answers;
mod client;
mod completion;
mod describe;
mod diagnostics;
mod formatting;
mod hints;
mod hover;
mod measures;
mod navigation;
mod outline;
mod place;
mod reference;
mod rename;
mod server;
mod session;
mod solutions;
mod text;
mod tokens;
mod uses;
mod words;
mod workspace;

pub use server::{Event, Server};

use lsp_server::Message;
use std::io::{self, BufReader};
use std::sync::mpsc::channel;

/// Serves a client over standard input and output until it says `exit`.
///
/// # Errors
///
/// The client went away without saying so, or sent what is no message of the protocol; the reason.
pub fn serve() -> Result<(), String> {
    let (events, queue) = channel();
    let reading = events.clone();
    // Ends with the process: a read cannot be given up.
    std::thread::spawn(move || {
        let mut input = BufReader::new(io::stdin());
        loop {
            let event = match Message::read(&mut input) {
                Ok(Some(message)) => Event::Message(message),
                Ok(None) => Event::Ended(None),
                Err(why) => Event::Ended(Some(why.to_string())),
            };
            let ended = matches!(event, Event::Ended(_));
            if reading.send(event).is_err() || ended {
                break;
            }
        }
    });
    let send = |message: Message| {
        // A client that reads no more has gone; its input ends, too.
        let _ = message.write(&mut io::stdout().lock());
    };
    Server::new(events, Box::new(send)).run(&queue)
}
