//! Who leans on whom: the support graph, and telling sleepers that one they lean
//! on has changed.
//!
//! What a support is, the policy says ([`Commands::lean_on`]); the engine keeps
//! the edges while the sleeper sleeps and asks the policy at the instant of a
//! change. That costs per change: nothing is asked as time goes by. Where the
//! policy wants to know that a supporter gets out of range, an alarm is set for
//! the time up to which it certainly does not.
//!
//! [`Commands::lean_on`]: crate::model::Commands::lean_on

use std::cmp::Reverse;

use serde::{Deserialize, Serialize};

use crate::engine::queue::{Key, Rank};
use crate::engine::simulation::Simulation;
use crate::engine::transitions::{Alarm, Call};
use crate::engine::view::View;
use crate::model::{EventOf, Model, Observer, SHORTEST_WAIT, StatePolicy};
use crate::particle::{Mode, ParticleId};
use crate::time::Time;

/// A sleeper leans on a grain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Edge {
    supporter: u32,
    /// The policy wants to know if it gets as far as this times the distance at
    /// contact.
    range: f64,
    /// The number of the call that is under way, so that many changes at one
    /// instant are one.
    call: Option<u64>,
    /// Until when it is certain to be within range, and the number of the alarm
    /// that is set for then.
    look: Option<(Time, u64)>,
}

/// The support graph. It takes no room until a policy uses it.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaning {
    /// What each sleeper leans on, by id.
    supporters: Vec<Vec<Edge>>,
    /// Who leans on each grain, by id.
    dependants: Vec<Vec<u32>>,
}

impl Leaning {
    /// From now on `sleeper` leans on `supporter`.
    fn lean(&mut self, sleeper: u32, supporter: u32, range: f64) {
        let room = sleeper.max(supporter) as usize + 1;
        if self.supporters.len() < room {
            self.supporters.resize(room, Vec::new());
            self.dependants.resize(room, Vec::new());
        }
        let edges = &mut self.supporters[sleeper as usize];
        let Err(place) = edges.binary_search_by_key(&supporter, |edge| edge.supporter) else {
            return;
        };
        let edge = Edge {
            supporter,
            range,
            call: None,
            look: None,
        };
        edges.insert(place, edge);
        let dependants = &mut self.dependants[supporter as usize];
        if let Err(place) = dependants.binary_search(&sleeper) {
            dependants.insert(place, sleeper);
        }
    }

    /// A grain leans on nobody any more.
    fn let_go(&mut self, sleeper: u32) {
        let Some(edges) = self.supporters.get_mut(sleeper as usize) else {
            return;
        };
        for edge in std::mem::take(edges) {
            self.dependants[edge.supporter as usize].retain(|&other| other != sleeper);
        }
    }

    fn dependants(&self, supporter: u32) -> &[u32] {
        self.dependants
            .get(supporter as usize)
            .map_or(&[], Vec::as_slice)
    }

    fn edges(&self, sleeper: u32) -> &[Edge] {
        self.supporters
            .get(sleeper as usize)
            .map_or(&[], Vec::as_slice)
    }

    fn edge(&mut self, sleeper: u32, supporter: u32) -> Option<&mut Edge> {
        let edges = self.supporters.get_mut(sleeper as usize)?;
        let place = edges.binary_search_by_key(&supporter, |edge| edge.supporter);
        place.ok().map(|place| &mut edges[place])
    }

    /// A call is made under this number; false if one is under way.
    fn call(&mut self, sleeper: u32, supporter: u32, number: u64) -> bool {
        match self.edge(sleeper, supporter) {
            Some(edge) if edge.call.is_none() => {
                edge.call = Some(number);
                true
            }
            _ => false,
        }
    }

    /// The call of this number arrives; false if it is void, since the sleeper
    /// has woken in the meantime.
    fn arrive(&mut self, sleeper: u32, supporter: u32, number: u64) -> bool {
        match self.edge(sleeper, supporter) {
            Some(edge) if edge.call == Some(number) => {
                edge.call = None;
                true
            }
            _ => false,
        }
    }

    /// What is wrong with the edges of a grain, which may lean or not.
    pub(super) fn check(&self, grain: u32, may_lean: bool) -> Result<(), String> {
        let edges = self.edges(grain);
        if !edges.is_empty() && !may_lean {
            return Err(format!("grain {grain} is awake and leans: {edges:?}"));
        }
        let is_dependant = |edge: &Edge| self.dependants(edge.supporter).contains(&grain);
        if !edges.iter().all(is_dependant) {
            return Err(format!("nobody knows that grain {grain} leans: {edges:?}"));
        }
        let leans = |&other: &u32| {
            let edges = self.edges(other);
            edges.iter().any(|edge| edge.supporter == grain)
        };
        let dependants = self.dependants(grain);
        if !dependants.iter().all(leans) {
            return Err(format!("not all of {dependants:?} lean on grain {grain}"));
        }
        Ok(())
    }

    /// What has to be written down.
    pub(super) fn save(&self) -> Vec<Vec<Edge>> {
        self.supporters.clone()
    }

    /// The graph that was written down, of a number of grains.
    pub(super) fn restore(saved: Vec<Vec<Edge>>, count: usize) -> Result<Self, &'static str> {
        if saved.len() > count {
            return Err("a grain that is not there leans");
        }
        let mut dependants = vec![Vec::new(); saved.len()];
        for (sleeper, edges) in (0..).zip(&saved) {
            if !edges.is_sorted_by(|one, next| one.supporter < next.supporter) {
                return Err("the supporters of a grain are out of order");
            }
            if edges.iter().any(|edge| edge.range.is_nan()) {
                return Err("a grain leans within no range");
            }
            for edge in edges {
                let Some(leaning) = dependants.get_mut(edge.supporter as usize) else {
                    return Err("a grain leans on one that is not there");
                };
                leaning.push(sleeper);
            }
        }
        Ok(Leaning {
            supporters: saved,
            dependants,
        })
    }
}

impl<M: Model<D>, const D: usize> Simulation<M, D> {
    /// The grains that a sleeper leans on, as its policy has asked for
    /// ([`Commands::lean_on`]), by id; none if it is awake.
    ///
    /// [`Commands::lean_on`]: crate::model::Commands::lean_on
    pub fn supporters(&self, id: ParticleId) -> impl Iterator<Item = ParticleId> + '_ {
        let edges = self.leaning.edges(id.0);
        edges.iter().map(|edge| ParticleId(edge.supporter))
    }

    /// The sleepers that lean on a grain, by id.
    pub fn dependants(&self, id: ParticleId) -> impl Iterator<Item = ParticleId> + '_ {
        self.leaning
            .dependants(id.0)
            .iter()
            .copied()
            .map(ParticleId)
    }

    /// Files who is to lean on whom: sleepers, on any other grain.
    pub(super) fn lean(&mut self) {
        if self.commands.is_empty() {
            return;
        }
        let known = self.world.bodies.len() as u32;
        let wanted: Vec<_> = self.commands.drain_leaning().collect();
        for (ParticleId(sleeper), ParticleId(supporter), range) in wanted {
            let both_known = sleeper.max(supporter) < known;
            if both_known
                && sleeper != supporter
                && self.world.bodies[sleeper as usize].mode == Mode::Frozen
                && !range.is_nan()
            {
                self.leaning.lean(sleeper, supporter, range);
                self.look_after(sleeper, supporter);
            }
        }
    }

    /// A grain has woken: it leans on nobody any more.
    pub(super) fn let_go(&mut self, particle: u32) {
        self.leaning.let_go(particle);
    }

    /// A grain flies on another way from now on, and its mode may have changed. If
    /// it has, the policy is to be asked for all that lean on it, by id, when the
    /// collisions of this instant are over.
    pub(super) fn tell_dependants(&mut self, particle: u32, mode_changed: bool) {
        for place in 0..self.leaning.dependants(particle).len() {
            let sleeper = self.leaning.dependants(particle)[place];
            if mode_changed {
                self.call(sleeper, particle);
            }
            self.look_after(sleeper, particle);
        }
    }

    /// The policy is to be asked about a sleeper and one that it leans on.
    fn call(&mut self, sleeper: u32, supporter: u32) {
        let number = self.alarm_count + 1;
        if self.leaning.call(sleeper, supporter, number) {
            self.set_alarm(self.world.clock, sleeper, Call::SupportChanged(supporter));
        }
    }

    /// Sets an alarm, the number of which is the count of alarms from then on.
    fn set_alarm(&mut self, time: Time, particle: u32, call: Call<EventOf<M, D>>) {
        self.alarm_count += 1;
        self.alarms.push(Reverse(Alarm {
            key: Key {
                time,
                rank: Rank::Policy,
                low: particle,
                high: particle,
            },
            order: self.alarm_count,
            call,
        }));
    }

    /// Sees to it that the policy hears when a supporter gets out of range. While
    /// an alarm is set for before that, a change of its flight costs a bound.
    fn look_after(&mut self, sleeper: u32, supporter: u32) {
        let Some(&mut Edge { range, look, .. }) = self.leaning.edge(sleeper, supporter) else {
            return;
        };
        let body = &self.world.bodies[supporter as usize];
        // Those that sleep are carried along alike.
        if range == f64::INFINITY || body.mode == Mode::Frozen || body.still {
            return;
        }
        let stays = self
            .world
            .stays_near(&self.model, sleeper, supporter, range);
        if stays == 0.0 {
            self.call(sleeper, supporter);
            return;
        }
        let until = self.world.clock + stays.max(SHORTEST_WAIT);
        if until.is_finite() && look.is_none_or(|(earlier, _)| until < earlier) {
            self.set_alarm(until, sleeper, Call::Look(supporter));
            if let Some(edge) = self.leaning.edge(sleeper, supporter) {
                edge.look = Some((until, self.alarm_count));
            }
        }
    }

    /// An alarm of this number has come: where is the supporter now?
    pub(super) fn look_again(&mut self, sleeper: u32, supporter: u32, number: u64) {
        if let Some(edge) = self.leaning.edge(sleeper, supporter)
            && edge.look.is_some_and(|(_, set)| set == number)
        {
            edge.look = None;
            self.look_after(sleeper, supporter);
        }
    }

    /// The policy is asked for a sleeper since one that it leans on has changed.
    pub(super) fn support_changed<O: Observer<D>>(
        &mut self,
        sleeper: u32,
        supporter: u32,
        number: u64,
        observer: &mut O,
    ) {
        if !self.leaning.arrive(sleeper, supporter, number) {
            return;
        }
        let response = self.model.state_policy().on_support_change(
            ParticleId(sleeper),
            ParticleId(supporter),
            &View {
                model: &self.model,
                world: &self.world,
            },
            self.memories.make(sleeper),
            &mut self.commands,
        );
        self.schedule();
        self.counts.support += 1;
        self.carry_out_response(sleeper, response, observer);
    }
}
