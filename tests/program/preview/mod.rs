//! `lss preview`: what it serves, to whom, and what it writes; and the page in a browser.

mod client;
mod http;
mod pages;
