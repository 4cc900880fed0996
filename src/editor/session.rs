//! What a server knows of its client, for whoever answers.

use super::client::Client;
use super::solutions::Solutions;
use super::workspace::Workspace;

/// A client, its documents, and their solved layouts.
pub struct Session {
    pub client: Client,
    pub workspace: Workspace,
    pub solutions: Solutions,
}
