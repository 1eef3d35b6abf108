//! The window itself: events in, pixels out. What they mean is decided elsewhere.

use crate::actions::{flying, key_actions, mouse_actions};
use crate::canvas::{Area, Canvas};
use crate::desk::Desk;
use crate::events::Event;
use crate::overlay::overlay;
use crate::panel::panel;
use crate::preparing::Errand;
use crate::session::Session;
use crate::style;
use crate::textures::Textures;
use egui::{CentralPanel, Frame, Id, Panel, Rect, Sense, Ui, ViewportId};
use softbuffer::{Context, Surface};
use std::num::NonZeroU32;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, OwnedDisplayHandle};
use winit::window::{Window, WindowId};

/// Width of the panel in points.
const PANEL_WIDTH: f32 = 312.0;
/// Frames per second while keys fly the camera.
const FLYING_PAUSE: Duration = Duration::from_millis(16);

/// Tells whoever follows the program what happens in it.
pub type Note = Box<dyn Fn(&str)>;

/// Everything that the window needs.
pub struct Shell {
    /// What it shows.
    pub session: Session,
    /// To the thread that renders.
    pub desk: Arc<Desk>,
    /// To the thread that reads and saves.
    pub errands: Option<Sender<Errand>>,
    /// From both.
    pub events: Receiver<Event>,
    /// Hears of what happens.
    pub note: Note,
    /// Size of the window in points.
    pub size: (f64, f64),
    /// What went wrong so badly that there is no window.
    pub failure: Option<String>,
    start: Instant,
    context: egui::Context,
    textures: Textures,
    open: Option<OpenWindow>,
    /// When to draw again although nothing happens.
    next: Option<Instant>,
}

struct OpenWindow {
    window: Rc<Window>,
    surface: Surface<OwnedDisplayHandle, Rc<Window>>,
    input: egui_winit::State,
}

impl Shell {
    /// Before there is a window.
    pub fn new(
        session: Session,
        desk: Arc<Desk>,
        errands: Sender<Errand>,
        events: Receiver<Event>,
        note: Note,
        size: (f64, f64),
    ) -> Self {
        let context = egui::Context::default();
        style::apply(&context);
        Shell {
            session,
            desk,
            errands: Some(errands),
            events,
            note,
            size,
            failure: None,
            start: Instant::now(),
            context,
            textures: Textures::default(),
            open: None,
            next: None,
        }
    }

    /// Seconds since the beginning.
    fn time(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<OpenWindow, String> {
        let name = self.session.project.file_name().unwrap_or_default().to_string_lossy();
        let attributes = Window::default_attributes()
            .with_title(format!("{name} - Sunshine"))
            .with_inner_size(LogicalSize::new(self.size.0, self.size.1))
            .with_min_inner_size(LogicalSize::new(480.0, 320.0));
        let window = Rc::new(events.create_window(attributes).map_err(|error| error.to_string())?);
        let context = Context::new(events.owned_display_handle()).map_err(|error| error.to_string())?;
        let surface = Surface::new(&context, Rc::clone(&window)).map_err(|error| error.to_string())?;
        let scale = Some(window.scale_factor() as f32);
        let input =
            egui_winit::State::new(self.context.clone(), ViewportId::ROOT, &*window, scale, None, None);
        Ok(OpenWindow { window, surface, input })
    }

    /// Takes over what the other threads tell.
    fn hear(&mut self) {
        let time = self.time();
        while let Ok(event) = self.events.try_recv() {
            self.session.hear(event, time);
        }
        self.pass_on();
    }

    /// Tells the other threads what is wanted now, and the terminal what happened.
    fn pass_on(&mut self) {
        let time = self.time();
        for errand in self.session.errands() {
            if let Some(errands) = &self.errands {
                // Nobody is there only when a bug has ended the thread, which is told in the terminal.
                let _ = errands.send(errand);
            }
        }
        if let Some(request) = self.session.request(time) {
            self.desk.ask(request);
        }
        for note in self.session.messages.take_notes() {
            (self.note)(&note);
        }
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn draw(&mut self) -> Result<(), String> {
        let time = self.time();
        let Some(mut open) = self.open.take() else { return Ok(()) };
        let result = self.draw_in(&mut open, time);
        self.open = Some(open);
        result
    }

    fn draw_in(&mut self, open: &mut OpenWindow, time: f64) -> Result<(), String> {
        let size = open.window.inner_size();
        let (Some(width), Some(height)) = (NonZeroU32::new(size.width), NonZeroU32::new(size.height)) else {
            return Ok(());
        };
        let context = self.context.clone();
        let input = open.input.take_egui_input(&open.window);
        let mut is_flying = false;
        let mut output = context.run_ui(input, |ui| is_flying |= self.ui(ui, time));
        if let Some(text) = self.session.take_copied() {
            output.platform_output.commands.push(egui::OutputCommand::CopyText(text));
        }
        open.input.handle_platform_output(&open.window, std::mem::take(&mut output.platform_output));
        let scale = output.pixels_per_point;
        let gone = self.textures.update(&mut output.textures_delta);
        let meshes = context.tessellate(std::mem::take(&mut output.shapes), scale);

        let failed = |error: softbuffer::SoftBufferError| format!("the window cannot be drawn: {error}");
        open.surface.resize(width, height).map_err(failed)?;
        let mut buffer = open.surface.buffer_mut().map_err(failed)?;
        let (width, height) = (size.width as usize, size.height as usize);
        let mut canvas = Canvas { width, height, pixels: &mut buffer };
        canvas.clear(style::SURROUND);
        if let Some(frame) = &self.session.frame {
            canvas.draw_image(&frame.image, self.session.picture_area());
        }
        canvas.draw_meshes(&meshes, &self.textures, scale);
        open.window.pre_present_notify();
        buffer.present().map_err(failed)?;
        self.textures.forget(&gone);

        self.plan(&output, time, is_flying);
        // A camera that moved, a setting that changed.
        let moving = self.session.request(time);
        if let Some(request) = moving {
            self.desk.ask(request);
        }
        for errand in self.session.errands() {
            if let Some(errands) = &self.errands {
                let _ = errands.send(errand);
            }
        }
        for note in self.session.messages.take_notes() {
            (self.note)(&note);
        }
        Ok(())
    }

    /// When to draw again.
    fn plan(&mut self, output: &egui::FullOutput, time: f64, is_flying: bool) {
        let asked = output.viewport_output.get(&ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        // The camera comes to rest, and then the picture may become sharp.
        let resting = self.session.is_moving(time).then_some(Duration::from_millis(60));
        let fading = self.session.messages.next_change(time).map(Duration::from_secs_f64);
        let flying = is_flying.then_some(FLYING_PAUSE);
        let pause = [asked, resting, fading, flying].into_iter().flatten().min();
        // Longer than a day is for ever.
        self.next = pause.filter(|pause| pause.as_secs() < 86_400).map(|pause| Instant::now() + pause);
    }

    /// All that egui shows; `true` while keys fly the camera.
    fn ui(&mut self, ui: &mut Ui, time: f64) -> bool {
        let mut actions = key_actions(ui);
        if self.session.has_panel {
            let frame = Frame::new().fill(style::PANEL).inner_margin(egui::Margin::symmetric(12, 0));
            Panel::right("panel")
                .exact_size(PANEL_WIDTH)
                .resizable(false)
                .show_separator_line(false)
                .frame(frame)
                .show(ui, |ui| actions.extend(panel(ui, &mut self.session, time)));
        }
        let mut is_flying = false;
        CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.available_rect_before_wrap();
            let scale = ui.ctx().pixels_per_point();
            self.session.scale = scale;
            self.session.area = pixels(rect, scale);
            let picture = ui.interact(rect, Id::unique("picture"), Sense::click_and_drag());
            if picture.clicked() || picture.dragged() {
                // So that keys move the camera again after something was written.
                ui.memory_mut(|memory| {
                    if let Some(focused) = memory.focused() {
                        memory.surrender_focus(focused);
                    }
                });
            }
            actions.extend(mouse_actions(ui, &picture));
            if let Some(action) = flying(ui) {
                is_flying = true;
                actions.push(action);
            }
            actions.extend(overlay(ui, &mut self.session, rect, time));
        });
        for action in actions {
            self.session.act(action, time);
        }
        is_flying
    }

    fn end(&mut self, events: &ActiveEventLoop) {
        self.desk.end();
        self.errands = None;
        events.exit();
    }
}

fn pixels(rect: Rect, scale: f32) -> Area {
    let edge = |value: f32| (value * scale).round().max(0.0) as usize;
    let (x, y) = (edge(rect.min.x), edge(rect.min.y));
    Area { x, y, width: edge(rect.max.x).saturating_sub(x), height: edge(rect.max.y).saturating_sub(y) }
}

/// What wakes the window: another thread has something to tell.
#[derive(Clone, Copy, Debug)]
pub struct Wake;

impl ApplicationHandler<Wake> for Shell {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(events) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
                self.pass_on();
            }
            Err(reason) => {
                self.failure = Some(reason);
                self.end(events);
            }
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if matches!(cause, StartCause::ResumeTimeReached { .. }) {
            self.next = None;
            if let Some(open) = &self.open {
                open.window.request_redraw();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Wake) {
        self.hear();
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match &event {
            WindowEvent::RedrawRequested => {
                if let Err(reason) = self.draw() {
                    self.failure = Some(reason);
                    self.end(events);
                }
                return;
            }
            WindowEvent::CloseRequested => return self.end(events),
            WindowEvent::Occluded(is_hidden) => {
                self.session.is_hidden = *is_hidden;
                return self.pass_on();
            }
            WindowEvent::Resized(size) => {
                // A minimised window has no size on some systems.
                self.session.is_hidden = size.width == 0 || size.height == 0;
                open.window.request_redraw();
            }
            _ => {}
        }
        if open.input.on_window_event(&open.window, &event).repaint {
            open.window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(match self.next {
            Some(time) => ControlFlow::WaitUntil(time),
            None => ControlFlow::Wait,
        });
    }
}
