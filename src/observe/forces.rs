use crate::model::{Observer, Occurrence, OccurrenceKind, Surroundings};
use crate::particle::{ParticleId, Vector, WallId};
use crate::time::Time;

/// The forces on walls and on grains at rest: the momentum that collisions give
/// them.
///
/// Grains that are asleep or fixed transmit nothing to each other. So the force on
/// a base is that of the grains which bounce on the base itself; the weight of
/// those asleep on it is not part of it. What the ground takes up without a
/// contact, where grains fall asleep, wake, or are slowed by a guard, is told
/// apart. Together with that the momentum of all grains is accounted for, but
/// for what the default guard gives to the second grain of a pair that collides
/// among static ones: in a small heap at V_c = 10⁻³ that was 1 % of the whole.
///
/// ```
/// use grainfall::boundary::{Cuboid, Side};
/// use grainfall::collide::Restitution;
/// use grainfall::dynamics::UniformGravity;
/// use grainfall::engine::{Limits, Simulation};
/// use grainfall::model::Parts;
/// use grainfall::observe::ForceMeter;
/// use grainfall::policy::Never;
/// use grainfall::predict::Polynomial;
/// use grainfall::{Particle, Time, Vector, WallId};
///
/// # fn main() -> Result<(), grainfall::SetupError> {
/// // A ball that bounces on a floor for ever presses on it with its weight.
/// let model = Parts {
///     dynamics: UniformGravity::<2>::down(),
///     predictor: Polynomial,
///     collision_rule: Restitution::elastic(),
///     state_policy: Never,
///     boundary: Cuboid::new([Side::Open, Side::floor(0.0, 1.0)])?,
/// };
/// let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::zeros());
/// let mut simulation = Simulation::new(model, vec![ball])?;
/// let mut forces = ForceMeter::new(simulation.time());
/// // From the top of one flight to that of another: 2 s each, from 0.5 d.
/// simulation.run(&Limits::until(Time::from_units(20.0)), &mut forces);
/// let pressing = forces.on_wall(WallId(0), simulation.time());
/// assert!((pressing[1] + 1.0).abs() < 1e-9 && pressing[0] == 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ForceMeter<const D: usize> {
    since: Time,
    /// Momentum given to each static grain, by id, and to each wall.
    grains: Vec<Vector<D>>,
    walls: Vec<Vector<D>>,
    ground: Vector<D>,
}

impl<const D: usize> ForceMeter<D> {
    /// Nothing yet, at this time.
    #[must_use]
    pub fn new(since: Time) -> Self {
        ForceMeter {
            since,
            grains: Vec::new(),
            walls: Vec::new(),
            ground: Vector::zeros(),
        }
    }

    /// The mean force on a wall up to `now`, in mg.
    #[must_use]
    pub fn on_wall(&self, wall: WallId, now: Time) -> Vector<D> {
        self.mean(self.walls.get(wall.index()), now)
    }

    /// The mean force of grains that hit this one while it was asleep or fixed,
    /// up to `now`, in mg. Of a grain that woke in between, over the whole time.
    #[must_use]
    pub fn on_grain(&self, grain: ParticleId, now: Time) -> Vector<D> {
        self.mean(self.grains.get(grain.index()), now)
    }

    /// The mean force on all grains that `counted` names, together, up to `now`,
    /// in mg: on the base, if it names the fixed ones.
    #[must_use]
    pub fn on_grains(&self, counted: impl Fn(ParticleId) -> bool, now: Time) -> Vector<D> {
        let each = (0..).map(ParticleId).zip(&self.grains);
        let sum = each
            .filter(|(id, _)| counted(*id))
            .fold(Vector::zeros(), |sum, (_, momentum)| sum + momentum);
        self.mean(Some(&sum), now)
    }

    /// The mean force on the ground without contacts, up to `now`, in mg: from the
    /// momentum that grains lost when they fell asleep, less what they were given
    /// back when they woke, and from guards that changed a grain which took no
    /// part in the collision.
    #[must_use]
    pub fn by_sleep(&self, now: Time) -> Vector<D> {
        self.mean(Some(&self.ground), now)
    }

    fn mean(&self, momentum: Option<&Vector<D>>, now: Time) -> Vector<D> {
        momentum.map_or_else(Vector::zeros, |momentum| momentum / (now - self.since))
    }
}

/// Adds to a place in a list that grows as far as it has to.
fn add<const D: usize>(list: &mut Vec<Vector<D>>, place: usize, momentum: Vector<D>) {
    if place >= list.len() {
        list.resize(place + 1, Vector::zeros());
    }
    list[place] += momentum;
}

impl<const D: usize> Observer<D> for ForceMeter<D> {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        let given = -occurrence.impulse;
        match (occurrence.kind, occurrence.other, occurrence.wall) {
            (OccurrenceKind::Frozen, Some(other), _) => add(&mut self.grains, other.index(), given),
            (OccurrenceKind::Wall, _, Some(wall)) => add(&mut self.walls, wall.index(), given),
            (OccurrenceKind::Wake, Some(other), _) => {
                // It was at rest, and has more now than it was struck with.
                let start = after.ground_velocity(other);
                let gained = (occurrence.other_velocity - start) * after.particle(other).mass;
                self.ground -= gained - given;
            }
            (OccurrenceKind::Sleep | OccurrenceKind::CheckWake | OccurrenceKind::Guard, _, _) => {
                self.ground += given;
            }
            _ => {}
        }
    }
}
