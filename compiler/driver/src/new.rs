//! `plcc new`: a small project that builds and runs.

use crate::failure::Failure;
use std::path::Path;

const MAIN: &str = "\
(* A light that blinks while the switch is on. *)
PROGRAM Main
VAR_INPUT
  switch : BOOL := TRUE;
END_VAR
VAR_OUTPUT
  lamp : BOOL;
END_VAR
VAR
  phase : TON;
END_VAR

phase(IN := switch AND NOT phase.Q, PT := T#500ms);
IF phase.Q THEN
  lamp := NOT lamp;
END_IF;
IF NOT switch THEN
  lamp := FALSE;
END_IF;
END_PROGRAM
";

/// Makes the folder with project.toml and src/main.st; never overwrites.
pub fn create(folder: &Path) -> Result<(), Failure> {
    let name = folder
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .ok_or_else(|| Failure::usage("the new project needs a name"))?;
    let fine = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    if !name.chars().all(fine) {
        return Err(Failure::usage(format!("`{name}`: use letters, digits, `_`, `-` and `.` for a project name")));
    }
    if folder.exists() {
        return Err(Failure::device(format!("`{}` exists already", folder.display())));
    }
    let src = folder.join("src");
    std::fs::create_dir_all(&src).map_err(|e| Failure::io("make folder", &src, e))?;
    let project = format!(
        "[project]\nname = \"{name}\"\nversion = \"0.1.0\"\nsources = [\"src/**/*.st\"]\nprofile = \"strict\"\n"
    );
    for (path, text) in [(folder.join("project.toml"), project.as_str()), (src.join("main.st"), MAIN)] {
        std::fs::write(&path, text).map_err(|e| Failure::io("write", &path, e))?;
    }
    println!("made {0}/project.toml and {0}/src/main.st", folder.display());
    println!("try: plcc run {}/project.toml --virtual-time --cycles 200 --trace -", folder.display());
    Ok(())
}
