//! What an editor asks about a place.
