//! Generates the parser from `src/grammar.lalrpop` (a conflict in the grammar ends the build with an explanation).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    lalrpop::Configuration::new()
        .use_cargo_dir_conventions()
        .emit_rerun_directives(true)
        .process()
        .expect("src/grammar.lalrpop cannot be made a parser");
}
