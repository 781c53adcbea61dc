//! L-systems: passages described by a grammar.
//!
//! Prusinkiewicz, Lindenmayer: "The Algorithmic Beauty of Plants", 1990 (chapters 1.6 and 1.7: bracketed and
//! stochastic grammars); Mark, Berechet, Mahlmann, Togelius: "Procedural generation of 3D caves for games on the GPU",
//! 2015, for caves. Letters are rewritten by rules in each iteration; a turtle digs along the result. The text is never
//! expanded: a turtle keeps its position in the rules, and each branch has its own turtle, which digs one step at a time, so
//! that all branches grow at the same pace until the nodes are used up. If the whole grammar is dug before that, it starts
//! again from an earlier station. Added here: wander, a slope limit, rock between passages, and loops.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, the rules of `network`,
//! and memory and time limited by the number of nodes. Not promised: that every branch of a grammar finds room.

mod grammar;

use std::collections::VecDeque;
use std::f64::consts::TAU;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::network::{self, Growth, Network, PassagePoint, Rules, Size, ahead, in_order};
use super::{GenerateError, Generator};
use grammar::{FORWARD, Grammar, Production};
use plume_graph::Graph;
use plume_graph::Outside;
use plume_graph::rng::Rng;

/// Symbols read per node, and in addition to that, before a grammar is considered to dig too little.
const SYMBOLS: [u64; 2] = [256, 100_000];
/// Turns that a turtle tries if it is blocked, in degrees.
const DODGES_DEG: [f64; 5] = [0.0, 25.0, -25.0, 50.0, -50.0];

/// Settings of the L-system generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct LSystem {
    /// Number of nodes (stations on the centreline); the grammar is dug until they are used up.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// The axiom: what the grammar begins with.
    pub axiom: String,
    /// Rules like `A = F[+A]-A`, or `A 0.5 = FA` with a weight among the rules of one letter. F digs a step and needs no
    /// rule; `+` and `-` turn left and right, `^` and `&` pitch up and down, `!` narrows, `[` and `]` enclose a branch.
    pub rules: Vec<String>,
    /// Number of times that letters are rewritten.
    #[schemars(range(min = 1, max = 100))]
    pub iterations: u32,
    /// Length of a step, which is the distance between stations, in metres.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub step_m: f64,
    /// Angle of `+` and `-`, in degrees.
    #[schemars(range(min = 1.0, max = 120.0))]
    pub angle_deg: f64,
    /// Angle of `^` and `&`, in degrees.
    #[schemars(range(min = 0.0, max = 45.0))]
    pub pitch_deg: f64,
    /// Random wander of a passage: standard deviation of the turn at each step, in degrees.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub wander_deg: f64,
    /// Maximum inclination of a passage, in degrees.
    #[schemars(range(min = 1.0, max = 45.0))]
    pub max_slope_deg: f64,
    /// Minimum width of a passage, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_min_m: f64,
    /// Width of a passage at the start of the axiom, in metres.
    #[schemars(range(min = 1.5, max = 20.0))]
    pub width_max_m: f64,
    /// Factor on the width at each `!`.
    #[schemars(range(min = 0.1, max = 1.0))]
    pub narrowing: f64,
    /// Height of a passage above its floor relative to its width.
    #[schemars(range(min = 0.4, max = 2.0))]
    pub height_ratio: f64,
    /// Number of loops: 0 for none, 1 for as many as in real caves.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub loop_closure: f64,
    /// Minimum rock between passages that do not meet, in metres.
    #[schemars(range(min = 0.5, max = 20.0))]
    pub rock_m: f64,
}

impl Default for LSystem {
    fn default() -> Self {
        let rules = [
            "A 3 = FF^F-F[++!B]F+F&A",
            "A 3 = FF&F+F[--!B]F-F^A",
            "A 2 = FFF[++!A]F--FA",
            "B 3 = F+F-FB",
            "B 2 = FF[++B]F-F",
            "B 2 = F",
        ];
        Self {
            nodes: 150,
            axiom: "[A]++++A".to_owned(),
            rules: rules.map(str::to_owned).into(),
            iterations: 12,
            step_m: 4.0,
            angle_deg: 35.0,
            pitch_deg: 8.0,
            wander_deg: 12.0,
            max_slope_deg: 20.0,
            width_min_m: 2.0,
            width_max_m: 5.0,
            narrowing: 0.75,
            height_ratio: 0.75,
            loop_closure: 1.0,
            rock_m: 1.0,
        }
    }
}

impl Generator for LSystem {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        in_order(["width_min_m", "width_max_m"], [self.width_min_m, self.width_max_m])?;
        let grammar = Grammar::read(&self.axiom, &self.rules)?;
        network::grown(&self.rules(), seed, "l-system", |_, _| {
            let left = SYMBOLS[0] * u64::from(self.nodes) + SYMBOLS[1];
            let first =
                PassagePoint { position: Point3::origin(), size: Size::new(self.width_max_m, self.height_ratio) };
            (first, Dig { settings: self, grammar: &grammar, turtles: VecDeque::new(), left })
        })
    }
}

impl LSystem {
    fn rules(&self) -> Rules {
        Rules {
            nodes: self.nodes as usize,
            rock_m: self.rock_m,
            widest: Size::new(self.width_max_m, self.height_ratio),
            steepest_rad: self.max_slope_deg.to_radians(),
            junction: network::JUNCTION,
            loop_closure: self.loop_closure,
            spacing_m: self.step_m,
        }
    }
}

/// A position in the rules: the symbols of a production that have not been read yet.
#[derive(Clone, Copy)]
struct RuleCursor {
    production: usize,
    next: usize,
    end: usize,
    /// Number of iterations left for its letters.
    depth: u32,
}

/// Digs one branch.
struct Turtle {
    station: usize,
    yaw_rad: f64,
    pitch_deg: f64,
    width_m: f64,
    /// The open positions, the innermost last.
    parts: Vec<RuleCursor>,
}

/// A grammar that is being dug.
struct Dig<'a> {
    settings: &'a LSystem,
    grammar: &'a Grammar,
    /// The turtles, in the order of their turns.
    turtles: VecDeque<Turtle>,
    /// Number of symbols that may still be read.
    left: u64,
}

impl Growth for Dig<'_> {
    fn dig(&mut self, network: &mut Network, rng: &mut Rng) {
        while network.room() > 0 && self.left > 0 {
            let turtle = match self.turtles.pop_front() {
                Some(turtle) => turtle,
                None => match network.draw_opening(rng) {
                    Some(station) => self.begin(station, rng),
                    None => return,
                },
            };
            if let Some(turtle) = self.advance(turtle, network, rng) {
                self.turtles.push_back(turtle);
            }
        }
    }
}

impl Dig<'_> {
    fn begin(&self, station: usize, rng: &mut Rng) -> Turtle {
        let axiom = self.part(0, self.settings.iterations);
        let width_m = self.settings.width_max_m;
        Turtle { station, yaw_rad: rng.between(0.0, TAU), pitch_deg: 0.0, width_m, parts: vec![axiom] }
    }

    /// Reads on until a step is dug; `None` if the branch has ended or has no room.
    fn advance(&mut self, mut turtle: Turtle, network: &mut Network, rng: &mut Rng) -> Option<Turtle> {
        let settings = self.settings;
        let steepest = settings.max_slope_deg;
        while self.left > 0 {
            self.left -= 1;
            let (symbol, depth) = self.read(&mut turtle)?;
            match symbol {
                '+' => turtle.yaw_rad += settings.angle_deg.to_radians(),
                '-' => turtle.yaw_rad -= settings.angle_deg.to_radians(),
                '^' => turtle.pitch_deg = (turtle.pitch_deg + settings.pitch_deg).min(steepest),
                '&' => turtle.pitch_deg = (turtle.pitch_deg - settings.pitch_deg).max(-steepest),
                '!' => turtle.width_m = (turtle.width_m * settings.narrowing).max(settings.width_min_m),
                letter => match self.grammar.draw(letter, rng).filter(|_| depth > 0) {
                    Some(production) => turtle.parts.push(self.part(production, depth - 1)),
                    None if letter == FORWARD => {
                        turtle.station = self.step(&mut turtle, network, rng)?;
                        return Some(turtle);
                    }
                    None => {}
                },
            }
        }
        None
    }

    fn part(&self, production: usize, depth: u32) -> RuleCursor {
        RuleCursor { production, next: 0, end: self.grammar.productions[production].symbols.len(), depth }
    }

    /// The next symbol of a turtle, and the iterations left for it. A branch is passed to a new turtle.
    fn read(&mut self, turtle: &mut Turtle) -> Option<(char, u32)> {
        loop {
            let part = turtle.parts.last_mut()?;
            let Production { symbols, closing } = &self.grammar.productions[part.production];
            let (at, depth) = (part.next, part.depth);
            if at == part.end {
                turtle.parts.pop();
                continue;
            }
            if symbols[at] != '[' {
                part.next += 1;
                return Some((symbols[at], depth));
            }
            part.next = closing[at] + 1;
            let branch = RuleCursor { next: at + 1, end: closing[at], ..*part };
            // More branches than nodes can never all be dug.
            if self.turtles.len() < self.settings.nodes as usize {
                self.turtles.push_back(Turtle { parts: vec![branch], ..*turtle });
            }
            self.left = self.left.saturating_sub(1);
        }
    }

    /// Adds a step in the turtle's direction, or in a nearby direction, which turns the turtle.
    fn step(&self, turtle: &mut Turtle, network: &mut Network, rng: &mut Rng) -> Option<usize> {
        let settings = self.settings;
        let from = *network.position(turtle.station);
        let yaw_rad = turtle.yaw_rad + (settings.wander_deg * rng.normal()).to_radians();
        let size = Size::new(turtle.width_m, settings.height_ratio);
        for dodge in DODGES_DEG.map(f64::to_radians) {
            let position = from + settings.step_m * ahead(yaw_rad + dodge, turtle.pitch_deg.to_radians());
            if let Some(next) = network.lay(turtle.station, &[PassagePoint { position, size }], None) {
                turtle.yaw_rad = yaw_rad + dodge;
                return Some(next);
            }
        }
        None
    }
}
