//! `sunshine show`: how a picture or a film came about.

use crate::arguments::ShowArguments;
use crate::failure::Failure;

/// Prints what the files tell of themselves.
pub fn run(arguments: &ShowArguments) -> Result<String, Failure> {
    let mut text = String::new();
    for path in &arguments.files {
        let record =
            render::read_record(path).map_err(|source| Failure::Record { path: path.clone(), source })?;
        if arguments.files.len() > 1 {
            text.push_str(&format!("{}\n", path.display()));
        }
        text.push_str(&record);
    }
    Ok(text)
}
