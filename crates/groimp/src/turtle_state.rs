//! What turtle commands hand down to their descendants.

use crate::ReadError;
use crate::field_errors::wrong_value;
use crate::graph::Graph;
use crate::values::parse_number;
use scene::MaterialId;

/// Number of EGA colours.
pub(crate) const EGA_COLORS: i64 = 16;

/// A main value and the value that is in force until it is reset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Attribute<T> {
    pub main: T,
    pub local: T,
}

impl<T: Copy> Attribute<T> {
    pub fn new(value: T) -> Self {
        Attribute { main: value, local: value }
    }
}

/// The attributes that have an effect on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TurtleState {
    pub length: Attribute<f64>,
    pub diameter: Attribute<f64>,
    pub tropism: Attribute<f64>,
    /// EGA index; negative if `shader` counts.
    pub color: Attribute<i64>,
    pub shader: Attribute<Option<MaterialId>>,
}

impl Default for TurtleState {
    fn default() -> Self {
        TurtleState {
            length: Attribute::new(100.0),
            diameter: Attribute::new(0.1),
            tropism: Attribute::new(0.0),
            color: Attribute::new(14),
            shader: Attribute::new(None),
        }
    }
}

/// Attribute that a command changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Length,
    Diameter,
    Tropism,
    Color,
    /// Parameter, carbon, heartwood, internode count: no effect on the picture.
    Invisible,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    Set,
    Add,
    Mul,
    Reset,
}

/// A command of the families L, D, V, N, C, H, U, P.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StateCommand {
    target: Target,
    operation: Operation,
    local: bool,
}

impl StateCommand {
    /// The command of that class name: a letter and one of `Add`, `Mul`, `0`, `l`, `lAdd`, `lMul` or nothing.
    pub fn named(name: &str) -> Option<Self> {
        let target = match name.chars().next()? {
            'L' => Target::Length,
            'D' => Target::Diameter,
            'V' => Target::Tropism,
            'P' => Target::Color,
            'N' | 'C' | 'H' | 'U' => Target::Invisible,
            _ => return None,
        };
        let (operation, local) = match &name[1..] {
            "" => (Operation::Set, false),
            "Add" => (Operation::Add, false),
            "Mul" => (Operation::Mul, false),
            "0" => (Operation::Reset, false),
            "l" => (Operation::Set, true),
            "lAdd" => (Operation::Add, true),
            "lMul" => (Operation::Mul, true),
            _ => return None,
        };
        Some(StateCommand { target, operation, local })
    }

    /// Value of the field `argument` when it is missing. 1 for Mul is unverified.
    pub fn default_argument(self) -> f64 {
        if self.operation == Operation::Mul { 1.0 } else { 0.0 }
    }

    /// P or Pl, which carry a shader.
    pub fn sets_color(self) -> bool {
        self.target == Target::Color && self.operation == Operation::Set
    }

    /// Whether only the local value changes, for the next shoot.
    pub fn is_local(self) -> bool {
        self.local
    }

    /// The state below the command. `shader` is what P and Pl carry.
    pub fn apply(
        self,
        state: &TurtleState,
        initial: &TurtleState,
        argument: f64,
        shader: Option<MaterialId>,
    ) -> TurtleState {
        let mut next = *state;
        match self.target {
            Target::Length => next.length = self.number(state.length, initial.length.main, argument),
            Target::Diameter => next.diameter = self.number(state.diameter, initial.diameter.main, argument),
            Target::Tropism => next.tropism = self.number(state.tropism, initial.tropism.main, argument),
            Target::Color => {
                let main = Attribute { main: state.color.main as f64, local: state.color.local as f64 };
                let color = self.number(main, initial.color.main as f64, argument);
                next.color = Attribute { main: color.main.round() as i64, local: color.local.round() as i64 };
                if self.operation == Operation::Set {
                    next.shader.local = shader;
                    if !self.local {
                        next.shader.main = shader;
                    }
                }
            }
            Target::Invisible => {}
        }
        next
    }

    /// That Add and Mul start from the main value, also the local ones, is unverified.
    fn number(self, old: Attribute<f64>, initial: f64, argument: f64) -> Attribute<f64> {
        let new = match self.operation {
            Operation::Set => argument,
            Operation::Add => old.main + argument,
            Operation::Mul => old.main * argument,
            Operation::Reset => initial,
        };
        if self.local { Attribute { main: old.main, local: new } } else { Attribute::new(new) }
    }
}

/// The state that RGGRoot sets: that of the first model class in the file which stores one.
pub(crate) fn initial_turtle_state(graph: &Graph) -> Result<TurtleState, ReadError> {
    let mut state = TurtleState::default();
    let stored = graph.nodes.iter().find_map(|node| graph.values.find(node.fields, "initialTurtleState"));
    let Some(stored) = stored else { return Ok(state) };
    let number = |name: &str, default: f64| match graph.values.find(stored.members, name) {
        Some(value) => parse_number(value.text())
            .ok_or_else(|| wrong_value(graph, value, "initialTurtleState", name, "a number")),
        None => Ok(default),
    };
    state.length = Attribute::new(number("length", state.length.main)?);
    state.diameter = Attribute::new(number("diameter", state.diameter.main)?);
    state.tropism = Attribute::new(number("tropism", state.tropism.main)?);
    state.color = Attribute::new(number("color", state.color.main as f64)?.round() as i64);
    Ok(state)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_values_leave_the_main_value() {
        let initial = TurtleState::default();
        let apply = |name: &str, state: TurtleState, argument: f64| {
            StateCommand::named(name).unwrap().apply(&state, &initial, argument, None)
        };
        let d = apply("D", initial, 2.0);
        assert_eq!(d.diameter, Attribute::new(2.0));
        let l = apply("Dl", d, 5.0);
        assert_eq!((l.diameter.main, l.diameter.local), (2.0, 5.0));
        assert_eq!(apply("DlMul", l, 3.0).diameter.local, 6.0);
        assert_eq!(apply("DAdd", l, 3.0).diameter, Attribute::new(5.0));
        assert_eq!(apply("D0", l, 0.0).diameter, Attribute::new(0.1));
        assert_eq!(apply("P", l, 3.2).color, Attribute::new(3));
        assert_eq!(apply("N", l, 3.2), l);
        assert_eq!(StateCommand::named("Lx"), None);
        assert_eq!(StateCommand::named("é"), None);
    }
}
