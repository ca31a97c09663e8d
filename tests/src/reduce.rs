//! Makes a failing program small.
//!
//! In: a source text of one statement or declaration a line, indented, and a question that it answers with yes. Out: a text
//! that still does, in which no line, no run of lines and no frame of a compound statement can be missed.

/// Leaves out lines as long as `fails` stays TRUE. `fails` is asked some thousand times for a long program.
pub fn reduce(text: &str, fails: impl Fn(&str) -> bool) -> String {
    let mut lines: Vec<&str> = text.lines().filter(|l| !l.trim().is_empty()).collect();
    let join = |lines: &[&str]| lines.iter().map(|l| format!("{l}\n")).collect::<String>();
    if !fails(&join(&lines)) {
        return text.into();
    }
    loop {
        let before = lines.len();
        let mut size = (lines.len() / 2).max(1);
        loop {
            let mut at = 0;
            while at < lines.len() {
                let mut fewer = lines.clone();
                fewer.drain(at..(at + size).min(lines.len()));
                if fails(&join(&fewer)) {
                    lines = fewer;
                } else {
                    at += size;
                }
            }
            if size == 1 {
                break;
            }
            size = size.div_ceil(2).min(size - 1);
        }
        // Whole compound statements and POUs, and then their frames alone: `IF`, `ELSE`, `END_IF`.
        let mut at = 0;
        while at < lines.len() {
            let Some(frame) = frame(&lines, at) else {
                at += 1;
                continue;
            };
            let end = frame[frame.len() - 1];
            let without = |gone: &dyn Fn(usize) -> bool| -> Vec<&str> {
                lines.iter().enumerate().filter(|(n, _)| !gone(*n)).map(|(_, l)| *l).collect()
            };
            let tries = [without(&|n| (at..=end).contains(&n)), without(&|n| frame.contains(&n))];
            match tries.into_iter().find(|fewer| fails(&join(fewer))) {
                Some(fewer) => lines = fewer,
                None => at += 1,
            }
        }
        if lines.len() == before {
            return join(&lines);
        }
    }
}

/// The lines of a compound statement at its own depth of indentation, if one begins at `at`: up to the first that closes it.
fn frame(lines: &[&str], at: usize) -> Option<Vec<usize>> {
    let depth = |line: &str| line.len() - line.trim_start().len();
    let own = depth(lines[at]);
    let mut list = vec![at];
    // Statements end with a semicolon, what opens a frame does not.
    if lines[at].trim_end().ends_with(';') {
        return None;
    }
    for (n, line) in lines.iter().enumerate().skip(at + 1) {
        if depth(line) < own {
            return None;
        }
        if depth(line) == own {
            list.push(n);
            let text = line.trim_start();
            if text.starts_with("END_") || text.starts_with("UNTIL") {
                return Some(list);
            }
        }
    }
    None
}
