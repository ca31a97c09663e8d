//! Diagnostics as text (with codespan-reporting), one-liners, JSON and SARIF.

use crate::cli::{Color, MessageFormat};
use anstream::stream::IsTerminal;
use codespan_reporting::diagnostic as cs;
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term;
use plcc_diag::{Diagnostic, Diagnostics, FileId, Severity, SourceMap, Span};
use serde_json::{Value, json};
use std::io::Write;
use std::ops::Range;

/// Prints all messages to standard error, a closing count in the human forms.
pub fn print(diags: &Diagnostics, sources: &SourceMap, format: MessageFormat, color: Color) {
    let text = render(diags, sources, format, use_color(color));
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// NO_COLOR, CLICOLOR_FORCE and terminals, unless the flag decides.
fn use_color(color: Color) -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty() && v != "0");
    match color {
        Color::Always => true,
        Color::Never => false,
        Color::Auto => !set("NO_COLOR") && (set("CLICOLOR_FORCE") || std::io::stderr().is_terminal()),
    }
}

/// All messages as text.
pub fn render(diags: &Diagnostics, sources: &SourceMap, format: MessageFormat, color: bool) -> String {
    let list = diags.sorted();
    match format {
        MessageFormat::Human => human(&list, sources, color),
        MessageFormat::Short => {
            let mut out: String = list.iter().map(|d| short(d, sources) + "\n").collect();
            out.push_str(&summary(&list));
            out
        }
        MessageFormat::Json => list.iter().map(|d| json_message(d, sources).to_string() + "\n").collect(),
        MessageFormat::Sarif => format!("{:#}\n", sarif(&list, sources)),
    }
}

fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Hint => "hint",
    }
}

/// `file:line:column: error[E0301]: message`.
fn short(d: &Diagnostic, sources: &SourceMap) -> String {
    format!("{}: {}[{}]: {}", sources.position(d.primary.span), word(d.severity()), d.code, d.message)
}

fn summary(list: &[&Diagnostic]) -> String {
    let count = |s| list.iter().filter(|d| d.severity() == s).count();
    let part = |n: usize, what: &str| (n > 0).then(|| format!("{n} {what}{}", if n == 1 { "" } else { "s" }));
    let parts: Vec<String> = [
        part(count(Severity::Error), "error"),
        part(count(Severity::Warning), "warning"),
        part(count(Severity::Hint), "hint"),
    ]
    .into_iter()
    .flatten()
    .collect();
    if parts.is_empty() { String::new() } else { format!("{}\n", parts.join(", ")) }
}

fn human(list: &[&Diagnostic], sources: &SourceMap, color: bool) -> String {
    let config = term::Config { before_label_lines: 0, after_label_lines: 0, ..term::Config::default() };
    let files = Sources(sources);
    let mut out = Vec::new();
    for d in list {
        let severity = match d.severity() {
            Severity::Error => cs::Severity::Error,
            Severity::Warning => cs::Severity::Warning,
            Severity::Hint => cs::Severity::Help,
        };
        let range = |s: Span| s.start as usize..s.end as usize;
        let mut labels =
            vec![cs::Label::primary(d.primary.span.file, range(d.primary.span)).with_message(&d.primary.text)];
        labels
            .extend(d.secondary.iter().map(|l| cs::Label::secondary(l.span.file, range(l.span)).with_message(&l.text)));
        let diagnostic = cs::Diagnostic::new(severity)
            .with_code(d.code.to_string())
            .with_message(&d.message)
            .with_labels(labels)
            .with_notes(d.help.iter().map(|h| format!("help: {h}")).collect());
        let done = if color {
            term::emit_to_write_style(
                &mut codespan_reporting::term::termcolor::Ansi::new(&mut out),
                &config,
                &files,
                &diagnostic,
            )
        } else {
            term::emit_to_write_style(
                &mut codespan_reporting::term::termcolor::NoColor::new(&mut out),
                &config,
                &files,
                &diagnostic,
            )
        };
        if done.is_err() {
            out.extend_from_slice(short(d, sources).as_bytes());
            out.push(b'\n');
        }
    }
    String::from_utf8_lossy(&out).into_owned() + &summary(list)
}

fn place(span: Span, sources: &SourceMap) -> Value {
    let file = sources.file(span.file);
    let (line, column) = file.line_column(span.start);
    let (end_line, end_column) = file.line_column(span.end);
    json!({ "file": file.name, "line": line, "column": column, "end_line": end_line, "end_column": end_column })
}

fn json_message(d: &Diagnostic, sources: &SourceMap) -> Value {
    let mut value = json!({
        "code": d.code.to_string(),
        "severity": word(d.severity()),
        "message": d.message,
        "help": d.help,
    });
    value["primary"] = json_label(&d.primary, sources);
    value["secondary"] = d.secondary.iter().map(|l| json_label(l, sources)).collect();
    value
}

fn json_label(label: &plcc_diag::Label, sources: &SourceMap) -> Value {
    let mut value = place(label.span, sources);
    value["text"] = json!(label.text);
    value
}

fn sarif(list: &[&Diagnostic], sources: &SourceMap) -> Value {
    let region = |s: Span| {
        let file = sources.file(s.file);
        let (line, column) = file.line_column(s.start);
        let (end_line, end_column) = file.line_column(s.end);
        json!({
            "artifactLocation": { "uri": file.name },
            "region": { "startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column },
        })
    };
    let mut codes: Vec<_> = list.iter().map(|d| d.code.info()).collect();
    codes.sort_by_key(|c| c.code);
    codes.dedup_by_key(|c| c.code);
    let rules: Vec<Value> = codes
        .iter()
        .map(|c| json!({ "id": c.code, "shortDescription": { "text": c.title }, "help": { "text": c.page } }))
        .collect();
    let results: Vec<Value> = list
        .iter()
        .map(|d| {
            let level = match d.severity() {
                Severity::Hint => "note",
                s => word(s),
            };
            let text = std::iter::once(&d.message).chain(&d.help).cloned().collect::<Vec<_>>().join("; ");
            let related: Vec<Value> = d
                .secondary
                .iter()
                .map(|l| json!({ "physicalLocation": region(l.span), "message": { "text": l.text } }))
                .collect();
            json!({
                "ruleId": d.code.to_string(),
                "level": level,
                "message": { "text": text },
                "locations": [{ "physicalLocation": region(d.primary.span) }],
                "relatedLocations": related,
            })
        })
        .collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "plcc", "version": env!("CARGO_PKG_VERSION"), "rules": rules } },
            "results": results,
        }],
    })
}

/// The source map as codespan-reporting wants it.
struct Sources<'s>(&'s SourceMap);

impl<'s> Files<'s> for Sources<'s> {
    type FileId = FileId;
    type Name = &'s str;
    type Source = &'s str;

    fn name(&'s self, id: FileId) -> Result<&'s str, Error> {
        Ok(&self.0.file(id).name)
    }
    fn source(&'s self, id: FileId) -> Result<&'s str, Error> {
        Ok(&self.0.file(id).text)
    }
    fn line_index(&'s self, id: FileId, byte: usize) -> Result<usize, Error> {
        Ok(self.0.file(id).line_column(byte as u32).0 as usize - 1)
    }
    fn line_range(&'s self, id: FileId, line: usize) -> Result<Range<usize>, Error> {
        self.0.file(id).line_range(line).ok_or(Error::LineTooLarge { given: line, max: self.0.file(id).line_count() })
    }
}
