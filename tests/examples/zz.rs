const ROWS: usize = 100;
use std::time::Instant;
fn main() {
    let text = std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap();
    let mut p = plcc_tests::compile::compile(&text, plcc_hir::Profile::Strict).unwrap();
    plcc_mir::opt::optimise(&mut p);
    let code = plcc_codegen::jit::compile(&p).unwrap();
    println!("code at {:p}", code.entries().1 as *const u8);
    let size = p.region_bytes as usize;
    for pad in [0usize, 64, 128, 256, 512, 1024, 2048] {
        let mut m = plcc_tests::memory::region(size + 8192 + 64);
        let m = plcc_tests::memory::bytes_of(&mut m);
        let base = (4096 - m.as_ptr() as usize % 4096) % 4096 + pad;
        let m = &mut m[base..base + size];
        code.init(m, true);
        let mut best = f64::MAX;
        let mut s = 12345u32;
        let rows: Vec<Vec<u8>> = (0..ROWS).map(|_| (0..64).flat_map(|_| { s = s.wrapping_mul(1103515245).wrapping_add(12345); ((s >> 16) as u16).to_le_bytes() }).collect()).collect();
        for _ in 0..200 {
            let t = Instant::now();
            for row in &rows {
                m[64..][..128].copy_from_slice(row);
                code.scan(m, 0, 0);
            }
            best = best.min(t.elapsed().as_nanos() as f64 / ROWS as f64);
        }
        println!("pad {pad} at {:p}: {best:.0} ns", m.as_ptr());
    }
}
