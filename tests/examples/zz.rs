use std::time::Instant;
fn main() {
    let text = std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap();
    let which: Vec<String> = std::env::args().skip(2).collect();
    let p0 = plcc_tests::compile::compile(&text, plcc_hir::Profile::Strict).unwrap();
    let mut p = p0.clone();
    plcc_mir::opt::optimise(&mut p);
    let mut lanes = vec![];
    for w in &which {
        let q = if w == "none" { &p0 } else { &p };
        let code = plcc_codegen::jit::compile(q).unwrap();
        println!("{w} code at {:p}", code.entries().1 as *const u8);
        lanes.push((code, plcc_tests::memory::region(q.region_bytes as usize), f64::MAX, q.region_bytes as usize));
    }
    let rows: Vec<Vec<u8>> = ["WEIGH;AX-4711;1250", "WEIGH;BB-12;77", "RESET;CC-1;0", "TARE;;9", "WEIGH;AX-4711;900;x"].iter().cycle().take(200).map(|t| { let mut v = t.as_bytes().to_vec(); v.resize(61, 0); v }).collect();
    for (code, m, _, n) in &mut lanes { code.init(&mut plcc_tests::memory::bytes_of(m)[..*n], true); }
    for _ in 0..20000 {
      for batch in rows.chunks(200) {
        for (code, m, best, n) in &mut lanes {
            let m = &mut plcc_tests::memory::bytes_of(m)[..*n];
            let t = Instant::now();
            for row in batch {
                m[64..][..61].copy_from_slice(row);
                code.scan(m, 0, 0);
            }
            *best = best.min(t.elapsed().as_nanos() as f64 / batch.len() as f64);
        }
      }
    }
    for (w, l) in which.iter().zip(&lanes) { println!("{w} {:.0}", l.2); }
}
