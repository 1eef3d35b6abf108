//! `sunshine generate`: manual pages and completions for shells, made of the definition of the command line.

use crate::arguments::{self, GenerateArguments};
use crate::failure::Failure;
use clap_complete::Shell;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes the files and returns their list.
pub fn run(generate: &GenerateArguments) -> Result<String, Failure> {
    let folder = &generate.folder;
    let not_writable = |path: &Path| {
        let path = path.to_owned();
        move |source| Failure::NotWritable { path, source }
    };
    std::fs::create_dir_all(folder).map_err(not_writable(folder))?;
    let mut command = arguments::command();
    command.build();
    let mut files: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut command.clone(), "sunshine", &mut script);
        let name = match shell {
            Shell::Zsh => "_sunshine".to_owned(),
            other => format!("sunshine.{other}"),
        };
        files.push((folder.join(name), script));
    }
    let pages = pages(&command).map_err(not_writable(folder))?;
    files.extend(pages.into_iter().map(|(name, page)| (folder.join(name), page)));
    let mut text = String::new();
    for (path, content) in files {
        render::write_whole_file(&path, |file| file.write_all(&content)).map_err(not_writable(&path))?;
        text.push_str(&format!("wrote {}\n", path.display()));
    }
    Ok(text)
}

/// The page of the program and those of its commands, as `man` names them.
fn pages(command: &clap::Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let mut pages = Vec::new();
    // Commands have commands.
    let mut pending = vec![command.clone()];
    while let Some(command) = pending.pop() {
        let shown = |below: &&clap::Command| !below.is_hide_set() && below.get_name() != "help";
        pending.extend(command.get_subcommands().filter(shown).cloned());
        let manual = clap_mangen::Man::new(command);
        let mut page = Vec::new();
        manual.render(&mut page)?;
        pages.push((manual.get_filename(), page));
    }
    Ok(pages)
}
