//! `plcc graph FILE`: charts as SVG, and networks from PLCopen XML.
//!
//! `chart` is what is drawn, `tree` its shape, `layout` places it; `network` places LD and FBD; `svg` writes both; `trace` knows the
//! active steps of a cycle.
//! Charts are taken from the syntax tree and texts from the source, so a chart is drawn as it is written, and also while
//! other parts of the program are still wrong.

mod chart;
mod layout;
mod network;
mod picture;
mod svg;
#[cfg(test)]
mod tests;
mod trace;
mod tree;

use crate::cli::GraphArgs;
use crate::failure::Failure;
use crate::pipeline::{self, Parsed};
use chart::{Action, Chart, Step, Transition};
use picture::{Picture, Rect, Shape};
use plcc_diag::{SourceMap, Span};
use plcc_syntax::ast;

/// Draws what the command line says.
pub fn graph(args: &GraphArgs, color: crate::cli::Color) -> Result<u8, Failure> {
    let (_, sources, ids) = pipeline::load(&args.sources)?;
    let drawn = sources.iter().any(|(_, file)| crate::project::is_xml(std::path::Path::new(&file.name)));
    if !args.sfc && !drawn {
        return Err(Failure::usage("say what to draw: --sfc draws the charts"));
    }
    let parsed = pipeline::parse(sources, &ids);
    crate::report(&parsed, None, args.sources.message_format, color)?;
    let mut charts = charts(&parsed, args.sfc)?;
    if let Some(wanted) = &args.pou {
        let names: Vec<String> = charts.iter().map(|c| c.name.clone()).collect();
        charts.retain(|c| c.name.eq_ignore_ascii_case(wanted) || c.pou.eq_ignore_ascii_case(wanted));
        if charts.is_empty() {
            let near = plcc_hir::similar(wanted, names.iter().map(String::as_str));
            let near = near.map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
            let what = if args.sfc { "chart" } else { "chart or network" };
            return Err(Failure::usage(format!("--pou: there is no {what} `{wanted}`{near}")));
        }
    }
    if charts.is_empty() {
        let what = if args.sfc { "Sequential Function Chart" } else { "body in LD, FBD or SFC" };
        return Err(Failure::usage(format!("there is no {what} in the sources")));
    }
    let mut cycle = None;
    if let Some(path) = &args.trace {
        let number = args.cycle.ok_or_else(|| Failure::usage("--trace needs --cycle N: which row to show"))?;
        let row = trace::Row::read(path, number)?;
        charts.retain(|c| c.network.is_none());
        for chart in &mut charts {
            row.mark(chart, args.instance.as_deref())?;
        }
        cycle = Some(number);
    }
    let text = svg::write(&sheet(&charts, cycle));
    write(&text, args.output.as_deref())?;
    Ok(0)
}

pub(crate) fn write(text: &str, output: Option<&std::path::Path>) -> Result<(), Failure> {
    let Some(path) = output.filter(|path| *path != std::path::Path::new("-")) else {
        use std::io::Write;
        return match std::io::stdout().lock().write_all(text.as_bytes()) {
            Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
                Err(Failure::device(format!("cannot write to standard output: {e}")))
            }
            _ => Ok(()),
        };
    };
    std::fs::write(path, text).map_err(|e| Failure::io("write", path, e))
}

/// A chart or a network with its names.
struct Named {
    /// `Main`, or `Main.Act` for an action.
    name: String,
    /// The POU that keeps its steps.
    pou: String,
    /// Empty for a network.
    chart: Chart,
    network: Option<ast::Network>,
}

/// All charts of the user's files, and networks unless only charts are asked for, in the order of the text.
fn charts(parsed: &Parsed, only_charts: bool) -> Result<Vec<Named>, Failure> {
    let mut found = Vec::new();
    for (_, _, builtin, file) in &parsed.files {
        if *builtin {
            continue;
        }
        let mut add = |name: String, pou: &str, body: &ast::Body| -> Result<(), Failure> {
            let (chart, network) = match body {
                ast::Body::Sfc(sfc) => (read(sfc, &parsed.sources)?, None),
                ast::Body::Network(network) if !only_charts => (Chart::default(), Some(network.clone())),
                _ => return Ok(()),
            };
            found.push(Named { name, pou: pou.to_string(), chart, network });
            Ok(())
        };
        for item in &file.items {
            match item {
                ast::Item::Pou(pou) => {
                    let name = &pou.name.text;
                    add(name.to_string(), name, &pou.body)?;
                    for action in &pou.actions {
                        add(format!("{name}.{}", action.name.text), name, &action.body)?;
                    }
                }
                // Outside of its POU, with the POU in its name.
                ast::Item::Action(action) => {
                    let name = &action.name.text;
                    add(name.to_string(), name.split('.').next().unwrap_or(name), &action.body)?;
                }
                _ => {}
            }
        }
    }
    Ok(found)
}

fn read(body: &ast::SfcBody, sources: &SourceMap) -> Result<Chart, Failure> {
    let mut chart = Chart::default();
    let xml = crate::project::is_xml(std::path::Path::new(&sources.file(body.span.file).name));
    let lines = |span: Span| match xml {
        true => plcc_syntax::without_comments(span.file, &plcc_syntax::plain_text(sources.text(span))),
        false => plcc_syntax::without_comments(span.file, sources.text(span)),
    };
    let text = |span: Span| lines(span).replace('\n', " ");
    for element in &body.elements {
        let ast::SfcElement::Step(step) = element else { continue };
        let action = |a: &ast::ActionAssociation| Action {
            qualifier: a.qualifier.as_ref().map_or("N".into(), |q| q.text.to_uppercase()),
            // An action inside a chart in XML has a name, but no text.
            name: ast::source::expression(&a.action),
            time: a.time.as_ref().map(|t| text(t.span)).unwrap_or_default(),
            indicator: a.indicators.iter().map(|i| text(i.span)).collect::<Vec<_>>().join(", "),
        };
        chart.steps.push(Step {
            name: step.name.text.to_string(),
            initial: step.initial,
            active: false,
            actions: step.actions.iter().map(action).collect(),
        });
    }
    for element in &body.elements {
        let ast::SfcElement::Transition(transition) = element else { continue };
        let steps = |names: &[ast::Name]| {
            let mut steps = Vec::new();
            for name in names {
                let Some(step) = chart.steps.iter().position(|s| s.name.eq_ignore_ascii_case(&name.text)) else {
                    let place = sources.position(name.span);
                    let message = format!("{place}: there is no step `{}`; `plcc check` says more", name.text);
                    return Err(Failure { code: 1, message });
                };
                steps.push(step);
            }
            steps.dedup();
            Ok(steps)
        };
        chart.transitions.push(Transition {
            name: transition.name.as_ref().map(|n| n.text.to_string()),
            priority: transition.priority.as_ref().map(|p| text(p.span)),
            condition: match &transition.condition {
                ast::Condition::St(e) => text(e.span),
                ast::Condition::Il(il) => lines(il.span),
                ast::Condition::Steps(_, e) => text(e.span),
                ast::Condition::Network(network) => drawn_condition(network),
            },
            from: steps(&transition.from)?,
            to: steps(&transition.to)?,
        });
    }
    Ok(chart)
}

/// A condition that is drawn, in a few words.
fn drawn_condition(network: &ast::Network) -> String {
    let end = network.elements.iter().find(|e| matches!(e.kind, ast::ElementKind::Condition));
    let from = end.and_then(|e| e.inputs.first()).and_then(|p| p.connections.first()).map(|c| c.from);
    let element = network.elements.iter().find(|e| Some(e.id) == from);
    match element.map(|e| &e.kind) {
        Some(ast::ElementKind::In { value: e, .. } | ast::ElementKind::Contact { variable: e, .. }) => {
            ast::print::print_expr(e)
        }
        Some(ast::ElementKind::Block { ty, instance: None }) => format!("{}(...)", ty.text),
        Some(ast::ElementKind::Block { instance: Some(instance), .. }) => ast::print::print_expr(instance),
        _ => "...".into(),
    }
}

/// All charts below each other, with headings where there are several or a cycle is shown.
fn sheet(charts: &[Named], cycle: Option<u64>) -> Picture {
    const HEADING: i32 = 32;
    let mut sheet = Picture::default();
    for named in charts {
        let mut picture = match &named.network {
            Some(network) => network::place(network),
            None => layout::place(&named.chart),
        };
        let title = match cycle {
            Some(cycle) => Some(format!("{}, cycle {cycle}", named.name)),
            None if charts.len() > 1 => Some(named.name.clone()),
            None => None,
        };
        if let Some(text) = title {
            let right = 24 + layout::width(&text) * 6 / 5;
            let rect = Rect { left: 24, top: sheet.height + 8, right, bottom: sheet.height + HEADING };
            sheet.shapes.push(Shape::Title { rect, text });
            sheet.height += HEADING;
            sheet.width = sheet.width.max(right + 24);
        }
        picture.shapes.iter_mut().for_each(|s| s.shift(0, sheet.height));
        sheet.height += picture.height;
        sheet.width = sheet.width.max(picture.width);
        sheet.shapes.extend(picture.shapes);
    }
    sheet
}
