//! The thread that renders: coarse while the camera moves, then sharp, then cleaner and cleaner.

use crate::desk::{Delivery, Desk, News, Request};
use crate::events::{Event, Frame, Report, explained};
use crate::schedule::{Pass, Schedule};
use crate::shown::{film_image, layer_image};
use bytemuck::Zeroable;
use kernels::records::kernel::LayerPixel;
use render::{
    Batch, ControlFlow, Device, DeviceError, Film, RenderSettings, automatic_exposure, relative_noise,
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Samples after which layers are smooth.
const LAYER_SAMPLES: u32 = 16;
/// Time between two looks at the noise, which is to cost little.
const NOISE_PAUSE: Duration = Duration::from_secs(1);

/// Opens the device that stands in for one that fails.
pub type OpenProcessor = Box<dyn Fn() -> Result<Box<dyn Device>, DeviceError> + Send>;

/// What the thread knows.
pub struct Refiner {
    desk: Arc<Desk>,
    report: Report,
    open_processor: OpenProcessor,
    scene: Option<Delivery>,
    request: Option<Request>,
    schedule: Schedule,
    film: Film,
    layers: Vec<LayerPixel>,
    /// Time that the picture took, that of its sharp passes, and the noise with the time when it was looked at.
    seconds: f64,
    sharp_seconds: f64,
    noise: Option<(f64, Instant)>,
    /// The last automatic exposure; a picture in motion does not flicker.
    exposure: Option<f32>,
    /// The last pass that was made.
    last: Option<Pass>,
}

impl Refiner {
    /// Begins with an empty desk.
    pub fn new(desk: Arc<Desk>, report: Report, open_processor: OpenProcessor) -> Self {
        Refiner {
            desk,
            report,
            open_processor,
            scene: None,
            request: None,
            schedule: Schedule::default(),
            film: Film::new(0, 0),
            layers: Vec::new(),
            seconds: 0.0,
            sharp_seconds: 0.0,
            noise: None,
            exposure: None,
            last: None,
        }
    }

    /// Works until the desk says that it is over.
    pub fn run(mut self) {
        loop {
            let News { request, delivery, is_over } = self.desk.take(self.next_pass().is_some());
            if is_over {
                return;
            }
            let is_delivered = delivery.is_some();
            if let Some(delivery) = delivery {
                self.scene = Some(delivery);
                self.schedule.forget_rate();
                self.restart();
            }
            if let Some(request) = request {
                self.turn_to(request, is_delivered);
            } else if is_delivered {
                self.look();
            }
            if let Some(pass) = self.next_pass() {
                self.make(pass);
            }
        }
    }

    fn turn_to(&mut self, request: Request, is_delivered: bool) {
        let old = self.request.replace(request);
        let (Some(new), old) = (&self.request, &old) else { return };
        let moved = old.as_ref().is_none_or(|old| old.camera != new.camera);
        let is_same_film = old.as_ref().is_some_and(|old| old.shares_film(new));
        let is_other_look = old.as_ref().is_some_and(|old| {
            old.shown != new.shown || old.exposure != new.exposure || old.tone_curve != new.tone_curve
        });
        let other_renderer = old.as_ref().is_some_and(|old| old.settings.renderer != new.settings.renderer);
        if other_renderer {
            self.schedule.forget_rate();
        }
        if !is_same_film {
            self.restart();
        } else if is_other_look && self.last.is_some() {
            self.publish();
        }
        if moved || is_delivered {
            self.look();
        }
    }

    /// Turns the camera of the scene.
    fn look(&mut self) {
        let (Some(scene), Some(request)) = (&mut self.scene, &self.request) else { return };
        let turned = scene.compiled.view(&request.camera).map_err(|error| explained(&error));
        let set = turned.and_then(|view| scene.loaded.set_view(&view).map_err(|error| explained(&error)));
        if let Err(reason) = set {
            (self.report)(Event::Refused(reason));
        }
    }

    fn restart(&mut self) {
        self.schedule.restart();
        self.seconds = 0.0;
        self.sharp_seconds = 0.0;
        self.noise = None;
        self.last = None;
    }

    /// What there is to do.
    fn next_pass(&self) -> Option<Pass> {
        let request = self.request.as_ref().filter(|request| !request.is_hidden)?;
        self.scene.as_ref()?;
        let pixels = u64::from(request.settings.width) * u64::from(request.settings.height);
        self.schedule.next(pixels, most_samples(request), request.is_moving)
    }

    fn make(&mut self, pass: Pass) {
        let (Some(scene), Some(request)) = (&self.scene, &self.request) else { return };
        let settings = RenderSettings {
            width: request.settings.width.div_ceil(pass.divisor),
            height: request.settings.height.div_ceil(pass.divisor),
            crop: None,
            ..request.settings.clone()
        };
        let batch =
            Batch { first_sample: pass.first_sample, samples: pass.samples, ..Batch::whole(&settings) };
        let before = self.desk.interruptions();
        // Coarse passes are short, and without any of them a camera that moves on and on would show nothing.
        let can_wait = pass.divisor == 1 || pass.first_sample > 0;
        let still = |_| match can_wait && self.desk.interruptions() != before || self.desk.is_over() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let count = settings.width as usize * settings.height as usize;
        let start = Instant::now();
        let made = if request.shown.is_layer() {
            if pass.first_sample == 0 {
                self.layers.clear();
                self.layers.resize(count, LayerPixel::zeroed());
            }
            scene.loaded.add_layers(&settings, &batch, &mut self.layers, &still)
        } else {
            if pass.first_sample == 0 {
                self.film = Film::new(settings.width, settings.height);
            }
            scene.loaded.add_samples(&settings, &batch, &mut self.film.pixels, &still)
        };
        let seconds = start.elapsed().as_secs_f64();
        let whole = u64::from(request.settings.width) * u64::from(request.settings.height);
        match made {
            Ok(()) => {
                // Of several devices those that are left go on.
                for failure in scene.loaded.failures() {
                    (self.report)(Event::Refused(failure));
                }
                self.schedule.made(pass, whole, seconds);
                self.seconds += seconds;
                if pass.divisor == 1 {
                    self.sharp_seconds += seconds;
                }
                self.last = Some(pass);
                self.publish();
            }
            // What was begun is of no use to anybody.
            Err(DeviceError::Cancelled) => self.restart(),
            Err(error) => self.fall_back(&error),
        }
    }

    /// Shows what there is.
    fn publish(&mut self) {
        let (Some(request), Some(pass)) = (&self.request, self.last) else { return };
        let samples = pass.first_sample + pass.samples;
        let most_samples = most_samples(request);
        let is_done = pass.divisor == 1 && samples >= most_samples;
        let mut exposure = 0.0;
        let image = if request.shown.is_layer() {
            layer_image(&self.layers, request.settings.width.div_ceil(pass.divisor) as usize, request.shown)
        } else {
            exposure = match (request.exposure, self.exposure) {
                (Some(stops), _) => stops,
                (None, Some(stops)) if request.is_moving => stops,
                (None, _) => *self.exposure.insert(automatic_exposure(&self.film)),
            };
            let is_due = self.noise.is_none_or(|(_, when)| when.elapsed() >= NOISE_PAUSE);
            if pass.divisor == 1 && samples >= 4 && (is_due || is_done) {
                self.noise = Some((relative_noise(&self.film), Instant::now()));
            }
            film_image(&self.film, exposure, request.tone_curve, request.shown)
        };
        let spent = if pass.divisor == 1 { self.sharp_seconds } else { self.seconds };
        let rays = if request.shown.is_layer() { 0 } else { self.film.rays() };
        (self.report)(Event::Frame(Box::new(Frame {
            image,
            is_sharp: pass.divisor == 1,
            is_done,
            samples,
            most_samples,
            seconds: self.seconds,
            rays_per_second: rays as f64 / spent.max(1e-6),
            noise: self.noise.map(|(noise, _)| noise).filter(|noise| noise.is_finite()),
            exposure,
        })));
    }

    /// Goes on with the processor, and says why.
    fn fall_back(&mut self, error: &DeviceError) {
        self.restart();
        let Some(lost) = self.scene.take() else { return };
        let reason = explained(error);
        if lost.is_processor {
            (self.report)(Event::Refused(reason));
            return;
        }
        (self.report)(Event::DeviceFailed(reason));
        let opened = (self.open_processor)().and_then(|device| {
            let loaded = device.load(Arc::clone(&lost.compiled))?;
            Ok(Delivery { loaded, compiled: lost.compiled, device: device.name(), is_processor: true })
        });
        match opened {
            Ok(delivery) => {
                (self.report)(Event::DeviceReady { name: delivery.device.clone(), stands_in: false });
                self.scene = Some(delivery);
                self.schedule.forget_rate();
                self.look();
            }
            Err(error) => (self.report)(Event::Refused(explained(&error))),
        }
    }
}

fn most_samples(request: &Request) -> u32 {
    match request.shown.is_layer() {
        true => request.settings.samples.min(LAYER_SAMPLES),
        false => request.settings.samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shown::Shown;
    use kernels::records::kernel::FilmPixel;
    use render::{CompiledScene, LoadedScene, Progress, ToneCurve, View, compile};
    use scene::{Camera, Scene};
    use std::sync::mpsc::{Receiver, channel};

    /// A device that makes grey pictures, or fails after some passes.
    struct Grey {
        passes_until_lost: Option<usize>,
    }

    struct GreyScene {
        passes_until_lost: Option<usize>,
        passes: std::sync::Mutex<usize>,
    }

    impl Device for Grey {
        fn name(&self) -> String {
            if self.passes_until_lost.is_some() { "card".to_owned() } else { "processor".to_owned() }
        }

        fn load(&self, _: Arc<CompiledScene>) -> Result<Box<dyn LoadedScene>, DeviceError> {
            let passes_until_lost = self.passes_until_lost;
            Ok(Box::new(GreyScene { passes_until_lost, passes: Default::default() }))
        }
    }

    impl LoadedScene for GreyScene {
        fn set_view(&mut self, _: &View) -> Result<(), DeviceError> {
            Ok(())
        }

        fn add_samples(
            &self,
            _: &RenderSettings,
            batch: &Batch,
            pixels: &mut [FilmPixel],
            progress: &Progress<'_>,
        ) -> Result<(), DeviceError> {
            let mut passes = self.passes.lock().unwrap();
            *passes += 1;
            if self.passes_until_lost.is_some_and(|most| *passes > most) {
                let reason = "the device was lost".to_owned();
                return Err(DeviceError::Gpu { device: "card".to_owned(), doing: "rendering", reason });
            }
            for pixel in pixels {
                pixel.samples += batch.samples;
                pixel.rays += 2 * batch.samples;
                pixel.radiance = [pixel.samples as f32; 3].into();
                pixel.squares = pixel.radiance;
            }
            match progress(1) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(DeviceError::Cancelled),
            }
        }

        fn add_layers(
            &self,
            _: &RenderSettings,
            batch: &Batch,
            pixels: &mut [LayerPixel],
            _: &Progress<'_>,
        ) -> Result<(), DeviceError> {
            pixels.iter_mut().for_each(|pixel| pixel.samples += batch.samples);
            Ok(())
        }
    }

    struct Thread {
        desk: Arc<Desk>,
        events: Receiver<Event>,
        running: Option<std::thread::JoinHandle<()>>,
    }

    impl Thread {
        fn start() -> Self {
            let desk = Arc::new(Desk::default());
            let (sender, events) = channel();
            let report: Report = Arc::new(move |event| sender.send(event).unwrap());
            let open = Box::new(|| Ok(Box::new(Grey { passes_until_lost: None }) as Box<dyn Device>));
            let refiner = Refiner::new(Arc::clone(&desk), report, open);
            let running = Some(std::thread::spawn(move || refiner.run()));
            Thread { desk, events, running }
        }

        fn deliver(&self, device: &Grey) {
            let compiled = Arc::new(compile(&Scene::default()).unwrap());
            let loaded = device.load(Arc::clone(&compiled)).unwrap();
            let is_processor = device.passes_until_lost.is_none();
            self.desk.deliver(Delivery { loaded, compiled, device: device.name(), is_processor });
        }

        fn next(&self) -> Event {
            self.events.recv_timeout(Duration::from_secs(60)).unwrap()
        }

        /// Waits for a finished picture; returns the events before it in words, and it.
        fn finished(&self) -> (Vec<String>, Box<Frame>) {
            let mut others = Vec::new();
            loop {
                match self.next() {
                    Event::Frame(frame) if frame.is_done => return (others, frame),
                    Event::Frame(_) => {}
                    Event::DeviceFailed(reason) | Event::Refused(reason) => others.push(reason),
                    Event::DeviceReady { name, .. } => others.push(name),
                    _ => others.push("something else".to_owned()),
                }
            }
        }
    }

    impl Drop for Thread {
        fn drop(&mut self) {
            self.desk.end();
            self.running.take().unwrap().join().unwrap();
        }
    }

    fn request() -> Request {
        Request {
            camera: Camera::default(),
            settings: RenderSettings { width: 32, height: 24, samples: 9, ..RenderSettings::default() },
            shown: Shown::Picture,
            exposure: Some(0.0),
            tone_curve: ToneCurve::Srgb,
            is_moving: false,
            is_hidden: false,
        }
    }

    #[test]
    fn a_picture_gets_all_its_samples_once_and_then_there_is_silence() {
        let thread = Thread::start();
        thread.desk.ask(request());
        thread.deliver(&Grey { passes_until_lost: None });
        let (others, frame) = thread.finished();
        assert!(others.is_empty() && frame.is_sharp, "{others:?}");
        assert_eq!((frame.samples, frame.image.width, frame.image.height), (9, 32, 24));
        assert!(frame.image.pixels.iter().all(|&pixel| pixel == 0x00ff_ffff));
        assert!(thread.events.recv_timeout(Duration::from_millis(100)).is_err());
        // Another brightness and another look need no new samples; another size does.
        thread.desk.ask(Request { exposure: Some(-1.0), ..request() });
        assert_eq!(thread.finished().1.image.pixels[0], 0x00bc_bcbc);
        // 1 becomes (1 + 1/16) / 2.
        thread.desk.ask(Request { tone_curve: ToneCurve::Reinhard, ..request() });
        assert_eq!(thread.finished().1.image.pixels[0], 0x00c1_c1c1);
        let settings = RenderSettings { width: 16, ..request().settings };
        thread.desk.ask(Request { settings, ..request() });
        assert_eq!(thread.finished().1.image.width, 16);
        thread.desk.ask(Request { shown: Shown::Normal, ..request() });
        assert_eq!(thread.finished().1.image.width, 32);
    }

    #[test]
    fn a_moving_picture_waits_for_the_camera_and_a_hidden_one_for_eyes() {
        let thread = Thread::start();
        thread.desk.ask(Request { is_hidden: true, ..request() });
        thread.deliver(&Grey { passes_until_lost: None });
        assert!(thread.events.recv_timeout(Duration::from_millis(100)).is_err());
        thread.desk.ask(Request { is_moving: true, ..request() });
        assert!(matches!(thread.next(), Event::Frame(frame) if !frame.is_done));
        assert!(thread.events.recv_timeout(Duration::from_millis(100)).is_err());
        thread.desk.ask(request());
        thread.finished();
    }

    #[test]
    fn the_processor_goes_on_when_a_card_is_lost() {
        let thread = Thread::start();
        thread.desk.ask(request());
        thread.deliver(&Grey { passes_until_lost: Some(1) });
        let (others, frame) = thread.finished();
        assert_eq!(others.len(), 2, "{others:?}");
        assert!(others[0].contains("the device was lost") && others[1] == "processor", "{others:?}");
        assert_eq!(frame.samples, 9);
    }
}
