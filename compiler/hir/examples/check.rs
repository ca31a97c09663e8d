fn main() {
    let args: Vec<String> = std::env::args().collect();
    std::thread::Builder::new().stack_size(512<<20).spawn(move || {
    let codesys = args[1] == "codesys";
    let profile = if codesys { plcc_hir::Profile::Codesys } else { plcc_hir::Profile::Strict };
    let mut map = plcc_diag::SourceMap::new();
    let mut diags = plcc_diag::Diagnostics::new();
    let mut files = vec![];
    for (n, t) in plcc_stdlib::blocks::blocks() {
        let id = map.add_builtin(*n, *t);
        files.push((id, plcc_hir::Profile::Strict, true, plcc_syntax::parse_file(id, t, plcc_hir::Profile::Strict, &mut diags)));
    }
    for f in &args[2..] {
        let bytes = std::fs::read(f).unwrap();
        let t = String::from_utf8(bytes).unwrap_or_else(|e| e.into_bytes().iter().map(|b| *b as char).collect());
        let id = map.add(f.as_str(), t.as_str());
        let start = std::time::Instant::now();
        files.push((id, profile, false, plcc_syntax::parse_file(id, &t, profile, &mut diags)));
        eprintln!("parse {:?}", start.elapsed());
    }
    let units: Vec<_> = files.iter().map(|(f, p, b, a)| plcc_hir::Unit { file: *f, ast: a, profile: *p, builtin: *b }).collect();
    let start = std::time::Instant::now();
    let checked = plcc_hir::check(&units, &Default::default(), &mut diags);
    eprintln!("check {:?}", start.elapsed());
    for d in diags.sorted() { println!("{}: {:?}[{}] {} -- {:?}", map.position(d.primary.span), d.severity(), d.code, d.message, d.help); }
    let _ = checked;
    }).unwrap().join().unwrap();
}
