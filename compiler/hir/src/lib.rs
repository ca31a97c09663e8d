//! The typed, resolved form of a program. Every notation becomes this as early as possible.

pub mod app;
pub mod body;
pub mod defs;
pub mod init;
pub mod types;

pub use app::Application;
pub use body::Body;
pub use defs::*;
pub use init::Init;
pub use types::{Type, TypeId, Types};
