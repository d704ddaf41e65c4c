use std::fmt::Write;

use crate::draw::palette::{Palette, hex, mixed};
use crate::draw::view::{Shape, View};
use crate::output::Frame;
use crate::particle::Mode;

/// Around the scene, in pixels.
const MARGIN: f64 = 16.0;
/// Height of a line of the legend, in pixels.
const LINE: f64 = 22.0;
/// Least width, so that the legend fits, in pixels.
const LEGEND_WIDTH: f64 = 330.0;

/// The SVG text as it grows.
pub(super) struct Canvas {
    text: String,
    /// Where the scene begins.
    left: f64,
    bottom: f64,
    plane: bool,
    /// How a grain of each shade is filled.
    fills: Vec<String>,
}

/// A number with one decimal, or none if that is 0.
fn short(value: f64) -> String {
    let tenths = (value * 10.0).round();
    if tenths % 10.0 == 0.0 {
        format!("{}", tenths / 10.0)
    } else {
        format!("{:.1}", tenths / 10.0)
    }
}

/// A time for people.
fn thousandths(time: f64) -> String {
    format!("{}", (time * 1000.0).round() / 1000.0)
}

/// The modes that occur, in the order of the legend.
fn modes(frame: &Frame) -> Vec<(Mode, usize)> {
    [Mode::Falling, Mode::Normal, Mode::Frozen, Mode::Fixed]
        .into_iter()
        .map(|mode| {
            let count = frame.grains.iter().filter(|g| g.mode == mode).count();
            (mode, count)
        })
        .filter(|(_, count)| *count > 0)
        .collect()
}

impl Canvas {
    pub(super) fn new(view: &View, frame: &Frame) -> Self {
        let lines = modes(frame).len() as f64 + 1.0;
        let inner = view.width().max(LEGEND_WIDTH);
        let width = inner + 2.0 * MARGIN;
        let height = view.height() + lines * LINE + 3.0 * MARGIN;
        let (width, height) = (width.ceil(), height.ceil());
        let time = thousandths(frame.time.units());
        let mut canvas = Canvas {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"0 0 {width} {height}\">\n<title>{} grains at t = {time}</title>\n",
                frame.grains.len()
            ),
            left: MARGIN + 0.5 * (inner - view.width()),
            bottom: MARGIN + view.height(),
            plane: frame.dimension == 2,
            fills: Vec::new(),
        };
        canvas.add("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
        if canvas.plane {
            let fill = |colour| {
                let edge = hex(mixed(colour, 0, 0.5));
                format!(
                    "fill=\"{}\" stroke=\"{edge}\" stroke-width=\".6\"",
                    hex(colour)
                )
            };
            canvas.fills = Palette::shades().map(fill).collect();
            return canvas;
        }
        canvas.add("<defs>\n");
        for (number, colour) in Palette::shades().enumerate() {
            canvas.fills.push(format!("fill=\"url(#g{number})\""));
            let stop = |at: &str, colour| {
                format!("<stop offset=\"{at}\" stop-color=\"{}\"/>", hex(colour))
            };
            canvas.add(&format!(
                "<radialGradient id=\"g{number}\" cx=\".36\" cy=\".32\" r=\".75\">{}{}{}</radialGradient>\n",
                stop("0", mixed(colour, 255, 0.6)),
                stop(".45", colour),
                stop("1", mixed(colour, 0, 0.55)),
            ));
        }
        canvas.add("</defs>\n");
        canvas
    }

    fn add(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &str) {
        let path = format!(
            "<path d=\"M{} {}L{} {}\" {style}/>\n",
            short(from.0 + self.left),
            short(from.1 + MARGIN),
            short(to.0 + self.left),
            short(to.1 + MARGIN),
        );
        self.add(&path);
    }

    /// The edges of the box: dashed across a periodic axis.
    pub(super) fn frame_lines(&mut self, view: &View, frame: &Frame) {
        let corners = if self.plane { 4 } else { 8 };
        for corner in 0..corners {
            for axis in 0..frame.dimension {
                let other = corner | 1 << axis;
                if other == corner {
                    continue;
                }
                let dashed = (0..frame.dimension).any(|k| k != axis && frame.periodic[k]);
                let style = if dashed {
                    "stroke=\"#999\" stroke-width=\".7\" stroke-dasharray=\"4 3\""
                } else {
                    "stroke=\"#999\" stroke-width=\".7\""
                };
                let from = view.point(&view.corner(corner));
                let to = view.point(&view.corner(other));
                self.line(from, to, style);
            }
        }
    }

    pub(super) fn grain(&mut self, shape: &Shape, shade: usize) {
        let (x, y) = (short(shape.x + self.left), short(shape.y + MARGIN));
        let radius = short(shape.radius.max(0.1));
        // Writing to a String cannot fail.
        let _ = writeln!(
            self.text,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {}/>",
            self.fills[shade]
        );
    }

    pub(super) fn legend(&mut self, frame: &Frame, palette: &Palette) {
        let mut y = self.bottom + MARGIN + 0.7 * LINE;
        self.add("<g font-family=\"sans-serif\" font-size=\"14\" fill=\"#222\">\n");
        self.add(&format!(
            "<text x=\"{MARGIN}\" y=\"{}\">t = {}, {} grains</text>\n",
            short(y),
            thousandths(frame.time.units()),
            frame.grains.len()
        ));
        for (mode, count) in modes(frame) {
            y += LINE;
            let mut x = MARGIN + 7.0;
            for shade in Palette::shades_of(mode) {
                let (fill, at) = (&self.fills[shade], (short(x), short(y - 5.0)));
                let sample = format!("<circle cx=\"{}\" cy=\"{}\" r=\"7\" {fill}/>", at.0, at.1);
                self.add(&sample);
                x += 15.0;
            }
            let energies = match (mode, palette.energies()) {
                (Mode::Normal, Some((low, high))) => {
                    format!(", kinetic energy {low:.1e} … {high:.1e} mgd")
                }
                _ => String::new(),
            };
            self.add(&format!(
                "<text x=\"{}\" y=\"{}\">{count} {}{energies}</text>\n",
                short(x),
                short(y),
                mode.name()
            ));
        }
        self.add("</g>\n");
    }

    pub(super) fn finish(mut self) -> String {
        self.add("</svg>\n");
        self.text
    }
}
