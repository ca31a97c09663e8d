//! Names of the hidden BOOLs by which a compiled chart tells the runtime that a step was activated while it was active (warning
//! W0609). The compiler declares them, the runtime finds them in the image; users cannot write a `$`.

/// A component of each step: it was activated while it was active.
pub const STEP: &str = "$twice";
/// How the name of a variable of the instance ends whose chart has such a step: `$merged`; of an ACTION's chart `$Act$merged`.
pub const CHART: &str = "merged";
