//! The first bytes of every resource's memory region: what compiled code, the engines and the runtime share.
//!
//! No variable lies here, so that reference 0 is NULL (semantics.md \[R1\]). All fields are little-endian.

/// `u32`: set to 1 by the watchdog; polled at the back-edges of loops.
pub const DEADLINE_FLAG: u32 = 0;
/// `u32`: a [`Fault`](crate::fault::Fault) number, 0 while there is none.
pub const FAULT_CODE: u32 = 4;
/// `i64`: the scan clock in nanoseconds, constant through a scan.
pub const CLOCK_NS: u32 = 8;
/// `u32`: index into the source table: where the fault happened.
pub const FAULT_SOURCE: u32 = 16;
/// `u32`: region offset of the instance whose code faulted; of a function that of the innermost instance that called it. 0
/// if there is none.
pub const FAULT_INSTANCE: u32 = 20;
/// `[i64; 3]`: the offending values; their meaning by fault stands in [`fault`](crate::fault).
pub const FAULT_OPERANDS: u32 = 24;
/// Size of the header, bytes; variables start here.
pub const HEADER_BYTES: u32 = 64;
