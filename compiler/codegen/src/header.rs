//! The C header of an embedded program, for `--emit header`.

use std::fmt::Write;

/// The header; `name` is that of the project and gives the include guard, `retain` the byte ranges (start, length) that
/// a host has to store if RETAIN variables are to survive.
pub fn header(name: &str, region_bytes: u32, task_names: &[&str], retain: &[(u32, u32)]) -> String {
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
    out
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

#ifdef __cplusplus
}
#endif

#endif
"#;
