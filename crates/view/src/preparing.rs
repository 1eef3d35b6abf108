//! The thread that does what takes long and renders nothing: reading, compiling, opening devices. Pictures are saved
//! on threads of their own, so that neither the view nor the next picture waits.

use crate::desk::{Delivery, Desk};
use crate::events::{Event, Report, SceneNews, explained};
use crate::saving::{SaveOrder, save};
use render::{
    Acceleration, CompiledScene, Device, DeviceChoice, DeviceError, Provenance, Renderer, compile_with,
};
use scene::{Scene, SunPosition};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::thread::JoinHandle;
use std::time::Instant;

/// A scene as a reader hands it over.
pub struct ReadScene {
    /// The scene; its camera is what the picture is taken with at first.
    pub scene: Scene,
    /// What the reader left out or was unsure of.
    pub warnings: Vec<String>,
    /// Layers of GroIMP that are drawn, layer n as bit n.
    pub visible_layers: u16,
}

/// Reads the scene, again whenever the project changes, with the given layers (layer n as bit n) or those of the project;
/// errors are in words.
pub type ReadFunction = Box<dyn Fn(Option<u16>) -> Result<ReadScene, String> + Send>;

/// Opens a device.
pub type OpenFunction = Arc<dyn Fn(DeviceChoice) -> Result<Box<dyn Device>, DeviceError> + Send + Sync>;

/// What a picture tells of itself, by the words of the command that makes it; without what is known only when it is
/// rendered: scene hash, device and samples.
pub type RecordFunction = Box<dyn Fn(&[String]) -> Provenance + Send>;

/// What is to be rendered by what.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Where the sun stands instead of where the project has it.
    pub sun: Option<SunPosition>,
    /// Haziness of the air instead of that of the project.
    pub turbidity: Option<f64>,
    /// Layers of GroIMP that are drawn instead of those of the project.
    pub visible_layers: Option<u16>,
    /// What renders.
    pub device: DeviceChoice,
    /// By which renderer first.
    pub renderer: Renderer,
}

/// Something to do.
pub enum Errand {
    /// Make a scene ready, read again if it is so.
    Prepare {
        /// What is wanted.
        wanted: Wanted,
        /// Whether the project has changed.
        reread: bool,
    },
    /// Save a picture.
    Save(Box<SaveOrder>),
}

/// A scene that was read.
#[derive(Clone)]
struct KnownScene {
    /// As it was read.
    scene: Arc<Scene>,
    warnings: Vec<String>,
    visible_layers: u16,
    /// With which layers that was asked for.
    asked_layers: Option<u16>,
}

/// What the thread knows.
pub struct Preparer {
    read: ReadFunction,
    open: OpenFunction,
    record: RecordFunction,
    acceleration: Acceleration,
    desk: Arc<Desk>,
    report: Report,
    /// As it was read, with the warnings.
    scene: Option<KnownScene>,
    compiled: Option<(Arc<CompiledScene>, Option<SunPosition>, Option<f64>)>,
    processor: Option<Arc<dyn Device>>,
    chosen: Option<(DeviceChoice, Arc<dyn Device>)>,
    gpus_are_listed: bool,
    saving: Vec<JoinHandle<()>>,
}

impl Preparer {
    /// Begins without a scene.
    pub fn new(
        read: ReadFunction,
        open: OpenFunction,
        record: RecordFunction,
        acceleration: Acceleration,
        desk: Arc<Desk>,
        report: Report,
    ) -> Self {
        Preparer {
            read,
            open,
            record,
            acceleration,
            desk,
            report,
            scene: None,
            compiled: None,
            processor: None,
            chosen: None,
            gpus_are_listed: false,
            saving: Vec::new(),
        }
    }

    /// Works until there are no more errands; pictures that are being saved are finished.
    pub fn run(mut self, errands: &Receiver<Errand>) {
        while let Ok(mut errand) = errands.recv() {
            loop {
                let next = errands.try_recv();
                // Of several wishes the last counts; a project that has changed stays changed.
                match (&mut errand, next) {
                    (
                        Errand::Prepare { wanted, reread },
                        Ok(Errand::Prepare { wanted: newer, reread: again }),
                    ) => {
                        *wanted = newer;
                        *reread |= again;
                    }
                    (_, Ok(other)) => {
                        self.run_errand(errand);
                        errand = other;
                    }
                    (_, Err(TryRecvError::Empty | TryRecvError::Disconnected)) => break,
                }
            }
            self.run_errand(errand);
        }
        for thread in self.saving {
            // It has told what went wrong.
            let _ = thread.join();
        }
    }

    fn run_errand(&mut self, errand: Errand) {
        match errand {
            Errand::Prepare { wanted, reread } => self.prepare(&wanted, reread),
            Errand::Save(order) => self.save(*order),
        }
    }

    fn prepare(&mut self, wanted: &Wanted, reread: bool) {
        match self.compile(wanted, reread) {
            Ok(is_new) => {
                self.deliver(wanted, is_new);
                self.list_gpus();
            }
            Err(reason) => (self.report)(Event::SceneFailed(reason)),
        }
    }

    /// Reads and compiles what is needed; `true` if the scene is another one.
    fn compile(&mut self, wanted: &Wanted, reread: bool) -> Result<bool, String> {
        let start = Instant::now();
        let has_layers = self.scene.as_ref().is_some_and(|known| known.asked_layers == wanted.visible_layers);
        let mut known = self.scene.clone();
        let mut is_other_scene = false;
        if reread || !has_layers {
            let ReadScene { scene, warnings, visible_layers } = (self.read)(wanted.visible_layers)?;
            is_other_scene = known.as_ref().is_none_or(|old| *old.scene != scene);
            let asked_layers = wanted.visible_layers;
            if is_other_scene {
                known = Some(KnownScene { scene: Arc::new(scene), warnings, visible_layers, asked_layers });
            } else if let Some(known) = &mut known {
                // What is compiled serves on.
                *known = KnownScene { warnings, visible_layers, asked_layers, ..known.clone() };
            }
        }
        let Some(known) = known else { return Ok(false) };
        let is_same_sky = self
            .compiled
            .as_ref()
            .is_some_and(|(_, sun, haze)| (*sun, *haze) == (wanted.sun, wanted.turbidity));
        if !is_other_scene && is_same_sky {
            if reread {
                (self.report)(Event::NothingNew);
            }
            self.scene = Some(known);
            return Ok(false);
        }
        let scene = with_daylight(&known.scene, wanted);
        // What cannot be compiled is not kept.
        let compiled = compile_with(&scene, self.acceleration).map_err(|error| explained(&error))?;
        let compiled = Arc::new(compiled);
        self.compiled = Some((Arc::clone(&compiled), wanted.sun, wanted.turbidity));
        let seconds = start.elapsed().as_secs_f64();
        let (warnings, visible_layers) = (known.warnings.clone(), known.visible_layers);
        self.scene = Some(known);
        let is_reread = reread;
        let news = SceneNews { scene, compiled, warnings, visible_layers, is_reread, seconds };
        (self.report)(Event::SceneRead(news));
        Ok(true)
    }

    /// Brings the scene to the device, to the processor first if the device has yet to be opened.
    fn deliver(&mut self, wanted: &Wanted, is_new: bool) {
        let is_chosen = self.chosen.as_ref().is_some_and(|(choice, _)| *choice == wanted.device);
        if is_chosen && !is_new {
            return;
        }
        let mut standing_in = None;
        if !is_chosen {
            // Whatever it was, its memory is needed no more.
            self.chosen = None;
            if wanted.device != DeviceChoice::Cpu {
                standing_in = self.stand_in();
            }
            match self.open_chosen(wanted.device) {
                Ok(device) if Some(device.name()) == standing_in => {
                    self.chosen = Some((wanted.device, device));
                    return (self.report)(Event::DeviceReady {
                        name: standing_in.unwrap_or_default(),
                        stands_in: false,
                    });
                }
                Ok(device) => self.chosen = Some((wanted.device, device)),
                Err(error) => return (self.report)(Event::DeviceFailed(explained(&error))),
            }
        }
        let (Some((_, device)), Some((compiled, ..))) = (&self.chosen, &self.compiled) else { return };
        let is_processor = self.processor.as_ref().is_some_and(|processor| processor.name() == device.name());
        match load(device, compiled, Some(wanted.renderer)) {
            Ok(loaded) => {
                let name = device.name();
                let compiled = Arc::clone(compiled);
                (self.report)(Event::DeviceReady { name: name.clone(), stands_in: false });
                self.desk.deliver(Delivery { loaded, compiled, device: name, is_processor });
            }
            Err(error) => {
                (self.report)(Event::DeviceFailed(explained(&error)));
                self.chosen = None;
                self.stand_in();
            }
        }
    }

    /// Tells once what the user may choose from.
    fn list_gpus(&mut self) {
        if !std::mem::replace(&mut self.gpus_are_listed, true) {
            let names = render::list_gpus().into_iter().map(|gpu| gpu.name);
            (self.report)(Event::Gpus(names.collect()));
        }
    }

    fn open_chosen(&mut self, choice: DeviceChoice) -> Result<Arc<dyn Device>, DeviceError> {
        match choice {
            DeviceChoice::Cpu => self.processor(),
            other => Ok(Arc::from((self.open)(other)?)),
        }
    }

    fn processor(&mut self) -> Result<Arc<dyn Device>, DeviceError> {
        if let Some(processor) = &self.processor {
            return Ok(Arc::clone(processor));
        }
        let opened: Arc<dyn Device> = Arc::from((self.open)(DeviceChoice::Cpu)?);
        Ok(Arc::clone(self.processor.insert(opened)))
    }

    /// Lets the processor render; returns its name.
    fn stand_in(&mut self) -> Option<String> {
        let compiled = Arc::clone(&self.compiled.as_ref()?.0);
        let loaded = self.processor().and_then(|device| Ok((load(&device, &compiled, None)?, device.name())));
        match loaded {
            Ok((loaded, name)) => {
                (self.report)(Event::DeviceReady { name: name.clone(), stands_in: true });
                let device = name.clone();
                self.desk.deliver(Delivery { loaded, compiled, device, is_processor: true });
                Some(name)
            }
            Err(error) => {
                (self.report)(Event::Refused(explained(&error)));
                None
            }
        }
    }

    fn save(&mut self, order: SaveOrder) {
        let device =
            self.chosen.as_ref().map(|(_, device)| Arc::clone(device)).or_else(|| self.processor.clone());
        let (Some(device), Some((compiled, ..))) = (device, &self.compiled) else {
            let reason = "there is no scene yet".to_owned();
            return (self.report)(Event::SaveFailed { path: order.path, reason });
        };
        let (compiled, report) = (Arc::clone(compiled), Arc::clone(&self.report));
        let record = (self.record)(&order.words);
        self.saving.retain(|thread| !thread.is_finished());
        self.saving.push(std::thread::spawn(move || {
            save(device.as_ref(), compiled, &order, record, &report);
        }));
    }
}

/// The scene with the sun that is wanted.
fn with_daylight(scene: &Arc<Scene>, wanted: &Wanted) -> Arc<Scene> {
    if (wanted.sun, wanted.turbidity) == (None, None) || scene.sky.is_none() {
        return Arc::clone(scene);
    }
    let mut changed = Scene::clone(scene);
    if let Some(sky) = &mut changed.sky {
        sky.set_daylight(wanted.sun, wanted.turbidity);
    }
    Arc::new(changed)
}

fn load(
    device: &Arc<dyn Device>,
    compiled: &Arc<CompiledScene>,
    renderer: Option<Renderer>,
) -> Result<Box<dyn render::LoadedScene>, DeviceError> {
    let loaded = device.load(Arc::clone(compiled))?;
    if let Some(renderer) = renderer {
        loaded.prepare(renderer)?;
    }
    Ok(loaded)
}
