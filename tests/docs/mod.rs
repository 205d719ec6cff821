//! What README and the pages in `docs/` say, held to what the programs do.

mod book;
mod commands;
mod events;
mod keys;
mod pages;
