//! Fig. 1: a bouncing ball.

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::{Guards, Limits, Settings, Simulation, StopReason};
use crate::error::SetupError;
use crate::model::{Occurrence, OccurrenceKind, Parts};
use crate::particle::{Particle, Vector};
use crate::plot::{Axis, Chart, Mark, Series};
use crate::policy::{Criterion, SlowDescent};
use crate::predict::Polynomial;
use crate::program::error::ProgramError;
use crate::program::estimate::Estimate;
use crate::program::reproduce::row::Row;
use crate::program::reproduce::{Context, Report, csv_of};
use crate::time::Time;

/// α_frozen, as the floor's restitution.
const RESTITUTION: f64 = 0.4;
/// V_c and V_sleep of the curves: large, to be seen.
const ELASTIC_SPEED: f64 = 0.2;
const SLEEP_SPEED: f64 = 0.3;
const UNTIL: f64 = 4.0;

/// A ball that first meets the floor at t = 1, with speed 1.
struct Ball {
    simulation:
        Simulation<Parts<UniformGravity<2>, Polynomial, Restitution, Criterion, Cuboid<2>>, 2>,
}

impl Ball {
    fn new(elastic_speed: f64, sleep_speed: f64) -> Result<Self, SetupError> {
        let sides = [Side::Open, Side::floor(0.0, RESTITUTION)];
        let model = Parts {
            dynamics: UniformGravity::<2>::down(),
            predictor: Polynomial,
            collision_rule: Restitution {
                elastic_speed,
                ..Restitution::default()
            },
            state_policy: Criterion::SlowDescent(SlowDescent {
                sleep_speed,
                wall_supports: true,
                ..SlowDescent::default()
            }),
            boundary: Cuboid::new(sides)?,
        };
        let ball = Particle::new(Vector::<2>::new(0.0, 1.0), Vector::<2>::zeros());
        let settings = Settings {
            guards: Guards {
                collapse: Some(1000),
                ..Guards::none()
            },
            ..Settings::default()
        };
        let simulation = Simulation::with_settings(model, vec![ball], settings)?;
        Ok(Ball { simulation })
    }

    /// Height of its lowest point over time, up to where it ends.
    fn curve(&mut self) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        for step in 0..=2000 {
            let time = UNTIL * f64::from(step) / 2000.0;
            let why = self
                .simulation
                .run(&Limits::until(Time::from_units(time)), &mut ());
            if why != StopReason::Time {
                break;
            }
            let ball = self.simulation.snapshot();
            points.push([time, ball[0].position.y - 0.5]);
        }
        points
    }
}

/// When a ball ends in a collapse, and when one falls asleep at V_sleep = 0.01.
fn times() -> Result<(f64, f64), SetupError> {
    let mut full = Ball::new(0.0, 0.0)?;
    full.simulation
        .run(&Limits::until(Time::from_units(UNTIL)), &mut ());
    let mut asleep = f64::NAN;
    let mut sleeping = Ball::new(1.0e-4, 0.01)?;
    let mut watch = |event: &Occurrence<2>| {
        if event.kind == OccurrenceKind::Sleep {
            asleep = event.time.units();
        }
    };
    sleeping
        .simulation
        .run(&Limits::until(Time::from_units(UNTIL)), &mut watch);
    Ok((full.simulation.time().units(), asleep))
}

pub(super) fn report(_: &Context<'_>) -> Result<Report, ProgramError> {
    let full = Ball::new(0.0, 0.0)?.curve();
    let regularised = Ball::new(ELASTIC_SPEED, 0.0)?.curve();
    let sleeping = Ball::new(ELASTIC_SPEED, SLEEP_SPEED)?.curve();
    let (stops, sleeps) = times()?;
    // V0 = 1 at t = 1.
    let exact = 2.0 * RESTITUTION / (1.0 - RESTITUTION);
    let printed = 2.0 / (1.0 - RESTITUTION);
    let chart = Chart::new("Fig. 1: a ball bounces on a floor")
        .with_axes(
            Axis::new("time", "√(d/g)").with_range(0.8, UNTIL),
            Axis::new("height", "d").with_range(-0.005, 0.1),
        )
        .with(Series::line("full dynamics", full.iter().copied()))
        .with(Series::dashed(
            "elastic below V_c",
            regularised.iter().copied(),
        ))
        .with(Series::line(
            "asleep below V_sleep",
            sleeping.iter().copied(),
        ))
        .with_mark(Mark::vertical(1.0 + exact, "t*"));
    let of = "Fig. 1";
    let rows = vec![
        Row::shown(
            of,
            "stop time t* after the first bounce, over V₀/g",
            Estimate::exact(stops - 1.0),
            1,
            "Times of flight are 2αV₀/g, 2α²V₀/g, …: their sum is 2αV₀/((1−α)g) = 1.33333. The \
             paper's 2V₀/((1−α)g) lacks the factor α.",
        )
        .beside(printed, 0.0, 0.0),
        Row::shown(
            of,
            "the same against the exact series",
            Estimate::exact(stops - 1.0),
            1,
            "The run without cut-off and sleep ends in the collapse itself.",
        )
        .beside(exact, 0.0, 1.0e-9),
        Row::shown(
            of,
            "falls asleep at (V_sleep = 0.01, V_c = 1e-4)",
            Estimate::exact(sleeps),
            1,
            "Half-way between two bounces, as the paper has it.",
        )
        .beside(2.329_510_4, 0.0, 1.0e-9),
    ];
    let curve = |name: &'static str, points: &[[f64; 2]]| {
        points
            .iter()
            .map(|[time, height]| vec![name.to_owned(), time.to_string(), height.to_string()])
            .collect::<Vec<_>>()
    };
    let mut table = curve("full", &full);
    table.extend(curve("regularised", &regularised));
    table.extend(curve("sleeping", &sleeping));
    Ok(Report {
        rows,
        files: vec![
            ("fig1.svg".to_owned(), chart.to_svg()?),
            (
                "fig1.csv".to_owned(),
                csv_of(&["curve", "time", "height"], &table)?,
            ),
        ],
    })
}
