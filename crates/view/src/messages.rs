//! What the window has to say.

/// Something that is said.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// In words.
    pub text: String,
    /// Whether something went wrong; such messages stay until they are closed.
    pub is_error: bool,
    /// When it was said, in seconds.
    time: f64,
}

/// How long what is no error is shown, in seconds.
const SHOWN: f64 = 4.0;
/// Most messages at a time.
const MOST: usize = 5;

/// What the window has to say.
#[derive(Default)]
pub struct Messages {
    shown: Vec<Message>,
    notes: Vec<String>,
}

impl Messages {
    /// Says something for a while.
    pub fn info(&mut self, text: String, time: f64) {
        self.say(Message { text, is_error: false, time });
    }

    /// Says that something went wrong.
    pub fn error(&mut self, text: String, time: f64) {
        self.say(Message { text, is_error: true, time });
    }

    /// Takes note of something for whoever follows the program from outside; the window shows it elsewhere.
    pub fn note(&mut self, text: String) {
        self.notes.push(text);
    }

    fn say(&mut self, message: Message) {
        let prefix = if message.is_error { "error: " } else { "" };
        self.notes.push(format!("{prefix}{}", message.text));
        // The same again takes the place of the first.
        self.shown.retain(|old| old.text != message.text);
        self.shown.push(message);
        if self.shown.len() > MOST {
            self.shown.remove(0);
        }
    }

    /// What is to be seen at a time in seconds.
    pub fn shown(&mut self, time: f64) -> &[Message] {
        self.shown.retain(|message| message.is_error || time - message.time < SHOWN);
        &self.shown
    }

    /// Seconds until a message vanishes, if one will.
    pub fn next_change(&self, time: f64) -> Option<f64> {
        let fading = self.shown.iter().filter(|message| !message.is_error);
        fading.map(|message| (message.time + SHOWN - time).max(0.0)).reduce(f64::min)
    }

    /// Closes a message.
    pub fn close(&mut self, text: &str) {
        self.shown.retain(|message| message.text != text);
    }

    /// Everything that was said or noted since the last time.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_and_others_vanish() {
        let mut messages = Messages::default();
        messages.error("broken".to_owned(), 0.0);
        messages.info("saved".to_owned(), 1.0);
        messages.note("picked".to_owned());
        assert_eq!(messages.shown(2.0).len(), 2);
        assert_eq!(messages.next_change(2.0), Some(3.0));
        assert_eq!(messages.shown(6.0).len(), 1);
        messages.close("broken");
        assert!(messages.shown(6.0).is_empty());
        assert_eq!(messages.take_notes(), ["error: broken", "saved", "picked"]);
        assert!(messages.take_notes().is_empty());
    }

    #[test]
    fn a_message_is_shown_once_and_few_at_a_time() {
        let mut messages = Messages::default();
        for _ in 0..3 {
            messages.error("broken".to_owned(), 0.0);
        }
        assert_eq!(messages.shown(0.0).len(), 1);
        for number in 0..20 {
            messages.error(number.to_string(), 0.0);
        }
        assert_eq!(messages.shown(0.0).len(), MOST);
    }
}
