//! The live preview: a page on the loopback that follows a layout's file.
//!
//! [`serve`] answers a browser on the same machine and nobody else. One thread checks and solves, one looks for changes
//! of the files, and each request has one of its own; they meet at the [`board`].
//!
//! - [`session`]: the file, and the thread that checks and solves it,
//! - [`watch`]: when to look at the file again,
//! - [`solving`]: a picture at once, and the whole,
//! - [`plan`], [`facts`], [`forces`], [`messages`], [`listing`]: what pages show,
//! - [`edit`], [`writing`]: a vertex at another place, in a text and on the disk,
//! - [`guard`], [`server`], [`page`]: who is answered, and with what.

mod board;
mod edit;
mod facts;
mod forces;
mod guard;
mod known;
mod listing;
mod messages;
mod page;
mod plan;
mod server;
mod session;
mod solving;
mod watch;
mod writing;

pub use forces::Forces;
pub use session::Settings;

use guard::Guard;
use server::Service;
use session::{Ask, Session};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tiny_http::Server;

/// Serves a preview until the user interrupts it. `ready` is told the address to open.
///
/// # Errors
///
/// Why it cannot begin: the port is taken, or the system has no random numbers; in a sentence.
pub fn serve(settings: &Settings, ready: impl FnOnce(&str)) -> Result<(), String> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, settings.port));
    let server = Server::http(address).map_err(|why| format!("could not listen on {address}: {why}"))?;
    let server = Arc::new(server);
    let port = server.server_addr().to_ip().map_or(settings.port, |address| address.port());
    let token = guard::token().map_err(|why| format!("the system gives no random numbers: {why}"))?;
    let session = Session::start(settings);
    let ended = Arc::new(AtomicBool::new(false));
    let handler = {
        let (server, session, ended) = (server.clone(), session.clone(), ended.clone());
        move || {
            ended.store(true, Ordering::Relaxed);
            session.ask(Ask::End);
            session.board.close();
            server.unblock();
        }
    };
    ctrlc::set_handler(handler).map_err(|why| format!("an interruption would not be noticed: {why}"))?;
    let watcher = {
        let (session, ended) = (session.clone(), ended.clone());
        std::thread::spawn(move || watch::watch(&session, &ended))
    };
    ready(&format!("http://127.0.0.1:{port}/{token}/"));
    Arc::new(Service::new(Guard::new(token, port), session)).run(&server);
    // It ends within a round; if it panicked before, there is nothing left to do either.
    ended.store(true, Ordering::Relaxed);
    let _ = watcher.join();
    Ok(())
}
