//! How a picture came about, as it is told in the files of pictures and films.

use crate::{Filter, RenderSettings, Sampler};
use std::fmt;

/// What must be the same for the same picture, and a little more.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Name of the scene's file, without its folder.
    pub scene: String,
    /// See [`crate::CompiledScene::hash`].
    pub scene_hash: String,
    /// Kind of the device, see [`crate::Device::kind`].
    pub device: String,
    /// Samples per pixel that were taken, on average.
    pub samples: u32,
    /// Options of the command line that give this picture: names without dashes, values.
    pub settings: Vec<(String, String)>,
}

/// In what two pictures differ so that they cannot be parts of the same.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Difference {
    /// The versions of the program.
    #[error("it was made by Sunshine {theirs}, this is {ours}; another version may compute in another way")]
    Version {
        /// That of the file.
        theirs: String,
        /// That of the other.
        ours: String,
    },
    /// A setting.
    #[error("it was made with {}, now there is {}", setting(name, theirs.as_deref()), setting(name, ours.as_deref()))]
    Setting {
        /// Name of the option without dashes.
        name: String,
        /// Value in the file; empty for one that takes none.
        theirs: Option<String>,
        /// Value of the other.
        ours: Option<String>,
    },
    /// The scene, although all settings are the same.
    #[error(
        "it shows another scene ({theirs}), or the project has changed since: not the same plants, lights, view or \
         textures"
    )]
    Scene {
        /// Name of the scene in the file.
        theirs: String,
    },
}

fn setting(name: &str, value: Option<&str>) -> String {
    match value {
        None => format!("no --{name}"),
        Some("") => format!("--{name}"),
        Some(value) => format!("--{name} {value}"),
    }
}

impl Provenance {
    /// What keeps a file from being continued or joined; `self` is the file.
    pub fn difference(&self, ours: &Provenance) -> Option<Difference> {
        if self.version != ours.version {
            return Some(Difference::Version { theirs: self.version.clone(), ours: ours.version.clone() });
        }
        let value = |of: &Provenance, name: &str| {
            of.settings.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone())
        };
        for (name, _) in self.settings.iter().chain(&ours.settings) {
            let (theirs, ours) = (value(self, name), value(ours, name));
            if theirs != ours {
                return Some(Difference::Setting { name: name.clone(), theirs, ours });
            }
        }
        (self.scene_hash != ours.scene_hash).then(|| Difference::Scene { theirs: self.scene.clone() })
    }

    /// The value of a setting.
    pub fn setting(&self, name: &str) -> Option<&str> {
        self.settings.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Reads what [`fmt::Display`] wrote; lines that mean nothing are passed over.
    pub fn parse(text: &str) -> Self {
        let mut read = Provenance::default();
        for line in text.lines() {
            if let Some(option) = line.strip_prefix("--") {
                let (name, value) = option.split_once(' ').unwrap_or((option, ""));
                read.settings.push((name.to_owned(), value.to_owned()));
            } else if let Some((key, value)) = line.split_once(": ") {
                match key {
                    "version" => read.version = value.to_owned(),
                    "scene" => read.scene = value.to_owned(),
                    "scene hash" => read.scene_hash = value.to_owned(),
                    "device" => read.device = value.to_owned(),
                    "samples per pixel" => read.samples = value.parse().unwrap_or(0),
                    _ => {}
                }
            }
        }
        read
    }
}

/// A line for each thing; settings as options, to be copied into a command.
impl fmt::Display for Provenance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Provenance { version, scene, scene_hash, device, samples, settings } = self;
        for (key, value) in
            [("version", version), ("scene", scene), ("scene hash", scene_hash), ("device", device)]
        {
            writeln!(f, "{key}: {}", in_one_line(value))?;
        }
        writeln!(f, "samples per pixel: {samples}")?;
        for (name, value) in settings {
            writeln!(f, "--{name} {}", in_one_line(value))?;
        }
        Ok(())
    }
}

/// Names of files may contain anything.
fn in_one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

impl RenderSettings {
    /// The settings as options of the command line: names without dashes, values. What never changes the picture is
    /// not among them.
    pub fn options(&self) -> Vec<(String, String)> {
        let RenderSettings {
            width,
            height,
            samples,
            depth,
            grid,
            seed,
            renderer,
            shadow_samples,
            background: [red, green, blue],
            sampler,
            filter,
            crop,
            tile: _,
        } = self;
        let sampler = match sampler {
            Sampler::Independent => "independent",
            Sampler::Sobol => "sobol",
        };
        let filter = match filter {
            Filter::Box => "box",
            Filter::Tent => "tent",
            Filter::Gaussian => "gaussian",
            Filter::BlackmanHarris => "blackman-harris",
        };
        let mut options = vec![
            ("renderer", renderer.to_string()),
            ("size", format!("{width}x{height}")),
            ("samples", samples.to_string()),
            ("depth", depth.to_string()),
            ("sampler", sampler.to_owned()),
            ("filter", filter.to_owned()),
            ("grid", grid.to_string()),
            ("seed", seed.to_string()),
            ("shadow-samples", shadow_samples.to_string()),
            ("background", format!("{red},{green},{blue}")),
        ];
        if let Some(crop) = crop {
            options.push(("crop", format!("{},{},{},{}", crop.x, crop.y, crop.width, crop.height)));
        }
        options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn provenance() -> Provenance {
        Provenance {
            version: "1.2".to_owned(),
            scene: "birch: the old\none.gsz".to_owned(),
            scene_hash: "00ff".to_owned(),
            device: "CPU".to_owned(),
            samples: 64,
            settings: RenderSettings::default().options(),
        }
    }

    #[test]
    fn it_is_read_back_whatever_the_scene_is_called() {
        let read = Provenance::parse(&provenance().to_string());
        assert_eq!(read, Provenance { scene: "birch: the old one.gsz".to_owned(), ..provenance() });
        assert_eq!(
            Provenance::parse("\0\n--\n: \n"),
            Provenance { settings: vec![(String::new(), String::new())], ..Provenance::default() }
        );
    }

    #[test]
    fn what_differs_is_named() {
        let ours = provenance();
        assert_eq!(ours.difference(&ours), None);
        // Device, name and number of samples may differ.
        let elsewhere =
            Provenance { device: "GPU".to_owned(), scene: "b".to_owned(), samples: 3, ..provenance() };
        assert_eq!(elsewhere.difference(&ours), None);
        let differs = |theirs: Provenance| theirs.difference(&ours).unwrap().to_string();
        assert!(differs(Provenance { version: "1.1".to_owned(), ..provenance() }).contains("Sunshine 1.1"));
        let deeper = RenderSettings { depth: 9, ..RenderSettings::default() }.options();
        let message = differs(Provenance { settings: deeper, ..provenance() });
        assert!(message.contains("--depth 9") && message.contains("--depth 5"), "{message}");
        let crop = Some(crate::CropWindow { x: 0, y: 0, width: 1, height: 2 });
        let part = RenderSettings { crop, ..RenderSettings::default() }.options();
        let message = differs(Provenance { settings: part, ..provenance() });
        assert!(message.contains("--crop 0,0,1,2") && message.contains("no --crop"), "{message}");
        let mut flagged = ours.settings.clone();
        flagged.push(("adaptive".to_owned(), String::new()));
        let message = differs(Provenance { settings: flagged, ..provenance() });
        assert!(message.contains("made with --adaptive, now there is no --adaptive"), "{message}");
        assert!(differs(Provenance { scene_hash: "1".to_owned(), ..provenance() }).contains("birch"));
    }
}
