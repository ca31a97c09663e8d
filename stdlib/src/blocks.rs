//! The standard function blocks, as ST source that is compiled with every project.

/// Name and text of each source.
pub fn sources() -> &'static [(&'static str, &'static str)] {
    &[
        ("bistable.st", include_str!("../blocks/bistable.st")),
        ("edge.st", include_str!("../blocks/edge.st")),
        ("counter.st", include_str!("../blocks/counter.st")),
        ("timer.st", include_str!("../blocks/timer.st")),
    ]
}
