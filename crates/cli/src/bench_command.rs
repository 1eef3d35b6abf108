//! `sunshine bench`: experiments whose times are written beside known ones, and measurements to compare.

mod compare;
mod machine;
mod matrix;
mod record;

use crate::arguments::{BenchArguments, BenchCommand, ThesisArguments};
use crate::failure::Failure;
use crate::progress::Messages;
use render::{DeviceChoice, automatic_exposure, automatic_gpu, list_gpus, open_device, write_picture};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use thesis::{Experiment, Machine, Scale};

/// Measures and returns the tables.
pub fn run(arguments: &BenchArguments) -> Result<String, Failure> {
    match &arguments.command {
        BenchCommand::Thesis(arguments) => thesis_experiments(arguments),
        BenchCommand::Run(arguments) => matrix::run(arguments),
        BenchCommand::Compare(arguments) => compare::run(arguments),
    }
}

fn thesis_experiments(arguments: &ThesisArguments) -> Result<String, Failure> {
    let messages = Messages { quiet: arguments.quiet };
    let machine = machine(arguments)?;
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => PathBuf::from(format!("thesis-{}", machine.name)),
    };
    std::fs::create_dir_all(&folder).map_err(not_writable(&folder))?;
    let scale = if arguments.quick { Scale::Quick } else { Scale::Full };
    if arguments.pictures {
        return thesis_pictures(&machine, scale, &folder, messages);
    }
    let mut text = format!("Experiments of the thesis of 2008 on {}\n", machine.name);
    for (name, device) in &machine.devices {
        let _ = writeln!(text, "{name}: {}", device.name());
    }
    text += "Times in seconds, without reading the scene and starting the device.\n";
    for experiment in thesis::all() {
        messages.line(&format!("{} ...", experiment.title));
        let section = one_experiment(&experiment, &machine, scale, &folder)?;
        text += &section;
    }
    let report = folder.join("thesis.txt");
    write_file(&report, text.as_bytes())?;
    let _ = writeln!(text, "\nwrote {}", folder.display());
    Ok(text)
}

/// Makes the pictures of the thesis and returns their list.
fn thesis_pictures(
    machine: &Machine,
    scale: Scale,
    folder: &Path,
    messages: Messages,
) -> Result<String, Failure> {
    let mut text = String::new();
    // There is always one.
    for (_, device) in machine.devices.iter().take(1) {
        for picture in thesis::pictures() {
            messages.line(&format!("{} ...", picture.title));
            let film = picture.render(device.as_ref(), scale)?;
            let file = folder.join(format!("{}.png", picture.name));
            write_picture(&film, &file, automatic_exposure(&film))?;
            let _ = writeln!(text, "{}: {}, {}", file.display(), picture.figure, picture.title);
        }
    }
    Ok(text)
}

fn one_experiment(
    experiment: &Experiment,
    machine: &Machine,
    scale: Scale,
    folder: &Path,
) -> Result<String, Failure> {
    let outcome = experiment.run(machine, scale)?;
    write_file(&folder.join(format!("{}.csv", experiment.name)), outcome.table.to_csv().as_bytes())?;
    for (name, plot) in &outcome.plots {
        write_file(&folder.join(format!("{name}.svg")), plot.to_svg()?.as_bytes())?;
    }
    for (name, film) in &outcome.pictures {
        write_picture(film, &folder.join(format!("{name}.png")), automatic_exposure(film))?;
    }
    Ok(format!("\n{}\n\n{}", experiment.title, outcome.table))
}

/// The devices that were asked for, or the processor and a graphics card if there is one.
fn machine(arguments: &ThesisArguments) -> Result<Machine, Failure> {
    let mut choices = arguments.device.clone();
    if choices.is_empty() {
        choices.push(DeviceChoice::Cpu);
        let card = automatic_gpu(&list_gpus());
        choices.extend(card.map(|number| DeviceChoice::Gpu(Some(number))));
    }
    let threads = arguments.threads.map(|threads| threads as usize);
    let mut devices = Vec::new();
    for choice in choices {
        let name = match choice {
            DeviceChoice::Auto => "auto".to_owned(),
            DeviceChoice::Cpu => "cpu".to_owned(),
            DeviceChoice::Gpu(None) => "gpu".to_owned(),
            DeviceChoice::Gpu(Some(number)) => format!("gpu{number}"),
            DeviceChoice::AllGpus => "gpu-all".to_owned(),
            DeviceChoice::All => "all".to_owned(),
        };
        devices.push((name, open_device(choice, threads)?));
    }
    Ok(Machine { name: host_name(), devices })
}

/// What the machine is called, fit for a file name.
fn host_name() -> String {
    let told = std::env::var("HOSTNAME").or_else(|_| std::env::var("COMPUTERNAME"));
    let name = told.or_else(|_| std::fs::read_to_string("/etc/hostname")).unwrap_or_default();
    let kept: String =
        name.trim().chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).collect();
    if kept.is_empty() { "machine".to_owned() } else { kept }
}

fn write_file(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    render::write_whole_file(path, |writer| writer.write_all(contents)).map_err(not_writable(path))
}

fn not_writable(path: &Path) -> impl FnOnce(std::io::Error) -> Failure {
    move |source| Failure::NotWritable { path: path.to_owned(), source }
}
