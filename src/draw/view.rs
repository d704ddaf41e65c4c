use crate::output::Frame;
use crate::particle::{Mode, Particle, Vector};

/// The largest picture, without its margins, in pixels.
const WIDEST: f64 = 800.0;
const HIGHEST: f64 = 1000.0;
/// The largest grain of diameter 1, in pixels.
const COARSEST: f64 = 60.0;
/// How far to the right of the front, and how far above, the eye is, in radians.
const TURN: f64 = 0.45;
const TILT: f64 = 0.25;

/// A grain in the picture, in pixels from the upper left corner of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) id: usize,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) radius: f64,
    /// Towards the eye, in pixels.
    pub(super) depth: f64,
}

/// How space is mapped to the picture.
#[derive(Clone, Debug)]
pub(super) struct View {
    right: Vector<3>,
    up: Vector<3>,
    towards: Vector<3>,
    /// Least coordinates along `right` and greatest along `up`, in d.
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    scale: f64,
    /// The part of the box that is shown.
    low: Vector<3>,
    high: Vector<3>,
    /// The axis that points up.
    upward: usize,
}

impl View {
    pub(super) fn of(frame: &Frame) -> Self {
        let plane = frame.dimension == 2;
        let (right, up, towards) = if plane {
            (Vector::x(), Vector::y(), Vector::z())
        } else {
            let (sin, cos) = (libm::sin(TURN), libm::cos(TURN));
            let right = Vector::<3>::new(cos, sin, 0.0);
            let front = Vector::<3>::new(sin, -cos, 0.0);
            let (rise, level) = (libm::sin(TILT), libm::cos(TILT));
            let up = Vector::<3>::z() * level - front * rise;
            let towards = front * level + Vector::<3>::z() * rise;
            (right, up, towards)
        };
        let upward = frame.dimension - 1;
        let low = Vector::<3>::from(frame.origin);
        let mut high = low + Vector::<3>::from(frame.lengths);
        if !frame.periodic[upward] {
            high[upward] = top_of(frame, upward, high[upward]);
        }
        let mut view = View {
            right,
            up,
            towards,
            left: f64::INFINITY,
            top: f64::NEG_INFINITY,
            width: 1.0,
            height: 1.0,
            scale: 1.0,
            low,
            high,
            upward,
        };
        let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut include = |point: &Vector<3>, margin: f64| {
            let (x, y) = (right.dot(point), up.dot(point));
            view.left = view.left.min(x - margin);
            most = most.max(x + margin);
            view.top = view.top.max(y + margin);
            least = least.min(y - margin);
        };
        for corner in 0..8 {
            include(&view_corner(&low, &high, corner), 0.05);
        }
        for grain in &frame.grains {
            if grain.position[upward] <= high[upward] {
                include(&grain.position, grain.radius());
            }
        }
        let (across, along) = (most - view.left, view.top - least);
        view.scale = (WIDEST / across).min(HIGHEST / along).min(COARSEST);
        view.width = across * view.scale;
        view.height = along * view.scale;
        view
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }

    pub(super) fn height(&self) -> f64 {
        self.height
    }

    /// Where a point of space lies in the picture.
    pub(super) fn point(&self, point: &Vector<3>) -> (f64, f64) {
        (
            (self.right.dot(point) - self.left) * self.scale,
            (self.top - self.up.dot(point)) * self.scale,
        )
    }

    /// A grain in the picture, unless it is above what is shown.
    pub(super) fn shape(&self, id: usize, grain: &Particle<3>) -> Option<Shape> {
        if grain.position[self.upward] > self.high[self.upward] {
            return None;
        }
        let (x, y) = self.point(&grain.position);
        Some(Shape {
            id,
            x,
            y,
            radius: grain.radius() * self.scale,
            depth: self.towards.dot(&grain.position) * self.scale,
        })
    }

    /// A corner of the shown part of the box; bit k of `corner` is axis k.
    pub(super) fn corner(&self, corner: usize) -> Vector<3> {
        view_corner(&self.low, &self.high, corner)
    }
}

fn view_corner(low: &Vector<3>, high: &Vector<3>, corner: usize) -> Vector<3> {
    Vector::from_fn(|axis, _| {
        if corner >> axis & 1 == 1 {
            high[axis]
        } else {
            low[axis]
        }
    })
}

/// Up to where the scene is shown: if grains are still falling, a little above
/// the highest of the others.
fn top_of(frame: &Frame, upward: usize, box_top: f64) -> f64 {
    let highest = |falling: bool| {
        frame
            .grains
            .iter()
            .filter(|grain| (grain.mode == Mode::Falling) == falling)
            .map(|grain| grain.position[upward] + grain.radius())
            .reduce(f64::max)
    };
    match (highest(false), highest(true)) {
        (Some(heap), Some(_)) => box_top.min(heap + frame.lengths[0]),
        _ => box_top,
    }
}
