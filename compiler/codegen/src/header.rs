//! The C header of an embedded program, for `--emit header`.

use std::fmt::Write;

/// The header; `name` is that of the project and gives the include guard, `retain` the byte ranges (start, length) that
/// a host has to store if RETAIN variables are to survive.
pub fn header(
    name: &str,
    region_bytes: u32,
    task_names: &[&str],
    retain: &[(u32, u32)],
    resources: &[Resource],
) -> String {
    let guard: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
    let mut out = String::new();
    let _ = write!(
        out,
        "/* {title}: interface of the compiled control program. */
#ifndef PLC_APP_{guard}_H
#define PLC_APP_{guard}_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern \"C\" {{
#endif

/* Bytes of the state region; it must be aligned to 64 bytes. */
#define PLC_APP_SIZE {region_bytes}u
#define PLC_APP_TASK_COUNT {tasks}u
",
        title = name.replace("*/", "* /"),
        tasks = task_names.len(),
    );
    for (n, task) in task_names.iter().enumerate() {
        let _ = writeln!(out, "/* task {n}: {} */", task.replace("*/", "* /"));
    }
    if !retain.is_empty() {
        out.push_str("\n/* Retained bytes of the region: {offset, size}. */\n");
        let _ = writeln!(out, "#define PLC_APP_RETAIN_COUNT {}u", retain.len());
        out.push_str("#define PLC_APP_RETAIN {");
        for (n, (start, length)) in retain.iter().enumerate() {
            let _ = write!(out, "{}{{{start}u, {length}u}}", if n > 0 { ", " } else { "" });
        }
        out.push_str("}\n");
    }
    out.push_str(BODY);
    if resources.len() > 1 {
        sharing(&mut out, resources);
    }
    out.push_str(END);
    out
}

/// A resource, for a host that runs several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Resource {
    /// Its name.
    pub name: String,
    /// First byte of its part of the region.
    pub start: u32,
    /// How many tasks it has; they follow those of the resources before.
    pub tasks: u32,
    /// What it shares: first byte in the shared part, first byte of its copy, bytes, bytes of one value (0: single bits).
    pub shares: Vec<[u32; 4]>,
}

/// What a host with several resources needs: where their parts lie, and the copying of what they share.
fn sharing(out: &mut String, resources: &[Resource]) {
    let _ = writeln!(out, "\n/* Resources: the part of each in the region starts with a fault record of its own. */");
    let _ = writeln!(out, "#define PLC_APP_RESOURCE_COUNT {}u", resources.len());
    for (n, resource) in resources.iter().enumerate() {
        let _ = writeln!(out, "/* resource {n}: {} */", resource.name.replace("*/", "* /"));
    }
    let starts: Vec<String> = resources.iter().map(|r| format!("{}u", r.start)).collect();
    let _ = writeln!(out, "#define PLC_APP_RESOURCE_START {{{}}}", starts.join(", "));
    let of_task = resources.iter().enumerate().flat_map(|(n, r)| (0..r.tasks).map(move |_| format!("{n}u")));
    let _ = writeln!(out, "#define PLC_APP_TASK_RESOURCE {{{}}}", of_task.collect::<Vec<_>>().join(", "));
    let taken = resources.iter().map(|r| r.shares.iter().map(|s| s[2]).sum::<u32>()).max().unwrap_or(0);
    let _ = writeln!(out, "\n/* Room for what a resource took. */\n#define PLC_APP_TAKEN_SIZE {}u", taken.max(1));
    let _ = writeln!(
        out,
        "\n/* Shared values: place in the shared part, in the resource's copy, bytes, bytes of one (0: single bits). */\n\
         struct plc_share {{\n    uint32_t resource, home, local, size, unit;\n}};\n\
         static const struct plc_share plc_app_shares[] = {{"
    );
    for (n, resource) in resources.iter().enumerate() {
        for [home, local, size, unit] in &resource.shares {
            let _ = writeln!(out, "    {{{n}u, {home}u, {local}u, {size}u, {unit}u}},");
        }
    }
    out.push_str("    {UINT32_MAX, 0u, 0u, 0u, 0u},\n};\n");
    out.push_str(SHARING);
}

const BODY: &str = r#"
/* A variable: `offset` in the region and `size`, bytes. */
struct plc_var {
    uint32_t offset, size;
    uint16_t type, flags;
    const char *path;
};

/* Bytes of the state region. */
size_t plc_app_size(void);

/* Initial values; cold = 0 keeps the retained bytes. Must come before the first scan. */
void plc_app_init(void *mem, int cold);

uint32_t plc_app_task_count(void);

/* Executes a task once; now_ns is the scan clock, nanoseconds, never falling.
   0, or a fault code; the first bytes of the region hold the details:
     u32 at 4 fault code, u32 at 16 row of the source table, u32 at 20 offset of the instance, i64[3] at 24 operands.
   Another thread may write 1 to the u32 at 0 to end a loop that takes too long. */
uint32_t plc_app_scan(void *mem, uint32_t task, int64_t now_ns);

/* A variable by its path, any case (`Main.t.Q`); NULL if there is none. */
const struct plc_var *plc_app_var(const char *path);
"#;

const SHARING: &str = r#"
/* Before an execution of a task of a resource: its copies of the shared values; `taken` keeps what they were. With
   threads, a lock has to be held here and in plc_app_give, and not between them. */
static inline void plc_app_take(void *mem, uint32_t resource, unsigned char *taken) {
    unsigned char *m = (unsigned char *)mem;
    const struct plc_share *s;
    uint32_t n;
    for (s = plc_app_shares; s->resource != UINT32_MAX; s++) {
        if (s->resource != resource) continue;
        for (n = 0; n < s->size; n++) *taken++ = m[s->local + n] = m[s->home + n];
    }
}

/* After it: each value that has changed is given back as a whole. */
static inline void plc_app_give(void *mem, uint32_t resource, const unsigned char *taken) {
    unsigned char *m = (unsigned char *)mem;
    const struct plc_share *s;
    uint32_t n, k, changed;
    for (s = plc_app_shares; s->resource != UINT32_MAX; s++) {
        if (s->resource != resource) continue;
        for (n = 0; n < s->size; n += s->unit ? s->unit : 1) {
            if (!s->unit) {
                changed = (uint32_t)(m[s->local + n] ^ taken[n]);
                m[s->home + n] = (unsigned char)((m[s->home + n] & ~changed) | (m[s->local + n] & changed));
                continue;
            }
            for (changed = 0, k = 0; k < s->unit; k++) changed |= (uint32_t)(m[s->local + n + k] ^ taken[n + k]);
            for (k = 0; changed && k < s->unit; k++) m[s->home + n + k] = m[s->local + n + k];
        }
        taken += s->size;
    }
}
"#;

const END: &str = r#"
#ifdef __cplusplus
}
#endif

#endif
"#;
