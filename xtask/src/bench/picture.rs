//! Size against speed, on logarithmic axes: what no codec betters in both is joined by a line.
//!
//! Colours are from M. Okabe and K. Ito, *Color Universal Design*, 2008.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::labels::{Rect, place};
use super::record::{is_ours, title};
use super::summary::{Mean, Summary};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const FAINT_INK: RGBColor = RGBColor(0x66, 0x66, 0x66);
const GRID_INK: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
const FRONT: RGBColor = RGBColor(0xe6, 0x9f, 0x00);
const OURS: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const RIVAL: RGBColor = RGBColor(0x77, 0x77, 0x77);

/// Lengths in pixels.
const PANEL_WIDTH: u32 = 620;
const PANEL_HEIGHT: u32 = 540;
const HEADER_HEIGHT: u32 = 88;
const FOOTER_HEIGHT: u32 = 64;
const LEFT: f64 = 70.0;
const RIGHT: f64 = PANEL_WIDTH as f64 - 24.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = PANEL_HEIGHT as f64 - 58.0;
const MARGIN: i32 = 24;

/// Height of a label, and width of a letter of one.
const LABEL_HEIGHT: f64 = 15.0;
const LETTER_WIDTH: f64 = 6.8;

/// Labels keep off lines, which are made of so many points between two codecs for that.
const STEPS: u32 = 60;

/// A codec: megabytes a second, and bits a sample.
struct Point {
    codec: String,
    speed: f64,
    size: f64,
}

/// Draws encoding and decoding side by side, and returns the picture as SVG.
pub(super) fn svg(summary: &Summary<'_>) -> String {
    let mut picture = String::new();
    let size = (2 * PANEL_WIDTH, HEADER_HEIGHT + PANEL_HEIGHT + FOOTER_HEIGHT);
    let root = SVGBackend::with_string(&mut picture, size).into_drawing_area();
    draw(&root, summary).expect("drawing into memory does not fail");
    drop(root);
    picture
}

fn draw(root: &Area<'_>, summary: &Summary<'_>) -> Drawn {
    root.fill(&WHITE)?;
    let (header, body) = root.split_vertically(HEADER_HEIGHT);
    let (body, footer) = body.split_vertically(PANEL_HEIGHT);
    draw_header(&header, summary)?;
    for (panel, (title, speed)) in body.split_evenly((1, 2)).iter().zip(PANELS) {
        draw_panel(panel, title, &points(summary, speed))?;
    }
    let notes = [
        "Geometric means over the volumes of the record; CPU time on one core. Lower is smaller, further right is faster.",
        "A codec that takes some of the volumes only stands at its size beside wavelift's on those.",
    ];
    for (note, y) in notes.into_iter().zip([14, 35]) {
        write(&footer, note, (MARGIN, y), text(13.0, &FAINT_INK, FontStyle::Normal))?;
    }
    root.present()
}

/// A panel's title, and the speed that it shows.
type Panel = (&'static str, fn(&Mean) -> f64);

const PANELS: [Panel; 2] = [("encoding, MB/s", |mean| mean.encode), ("decoding, MB/s", |mean| mean.decode)];

/// Every codec of a task. Sizes are multiples of those of the first one, which takes every volume.
fn points(summary: &Summary<'_>, speed: fn(&Mean) -> f64) -> Vec<Point> {
    let Some(&first) = summary.codecs.first() else { return vec![] };
    let unit = summary.mean(first).bits_per_sample;
    let point = |codec: &&str| Point {
        codec: (*codec).to_owned(),
        speed: speed(&summary.mean(codec)),
        size: unit * summary.ratio(codec, first),
    };
    summary.codecs.iter().map(point).collect()
}

fn draw_header(area: &Area<'_>, summary: &Summary<'_>) -> Drawn {
    let title = format!("{}: size against speed", title(summary.task));
    write(area, &title, (MARGIN, 32), text(24.0, &INK, FontStyle::Bold))?;
    let mut x = MARGIN + 6;
    for (colour, label, width) in [(OURS, "wavelift", 106), (RIVAL, "other codecs", 136)] {
        area.draw(&Circle::new((x, 66), 5, colour.filled()))?;
        write(area, label, (x + 12, 66), text(15.0, &INK, FontStyle::Normal))?;
        x += width;
    }
    area.draw(&PathElement::new([(x - 4, 66), (x + 22, 66)], FRONT.stroke_width(3)))?;
    write(area, "no codec is both smaller and faster", (x + 32, 66), text(15.0, &INK, FontStyle::Normal))
}

fn draw_panel(area: &Area<'_>, title: &str, points: &[Point]) -> Drawn {
    let across = Scale::new(points.iter().map(|point| point.speed), LEFT, RIGHT);
    let up = Scale::new(points.iter().map(|point| point.size), BOTTOM, TOP);
    draw_axes(area, title, &across, &up)?;
    let at = |point: &Point| (across.at(point.speed), up.at(point.size));
    // Efforts that another of wavelift's betters in both are on neither line.
    let ours: Vec<(f64, f64)> =
        front(points.iter().filter(|point| is_ours(&point.codec))).into_iter().map(at).collect();
    let front: Vec<(f64, f64)> = front(points.iter()).into_iter().map(at).collect();
    area.draw(&path(&ours, OURS.stroke_width(1)))?;
    area.draw(&path(&front, FRONT.stroke_width(3)))?;

    // wavelift's labels choose their places first.
    let mut points: Vec<&Point> = points.iter().collect();
    points.sort_by_key(|point| !is_ours(&point.codec));
    let places: Vec<(f64, f64)> = points.iter().map(|point| at(point)).collect();
    let width = |point: &&Point| LETTER_WIDTH * (point.codec.chars().count() + 1) as f64;
    let sizes: Vec<(f64, f64)> = points.iter().map(|point| (width(point), LABEL_HEIGHT)).collect();
    let panel = Rect { left: LEFT, top: TOP, right: RIGHT, bottom: BOTTOM };
    let labels = place(&places, &sizes, &[along(&front), along(&ours)].concat(), &panel);
    for ((point, &place), label) in points.iter().zip(&places).zip(&labels) {
        draw_point(area, &point.codec, place, label)?;
    }
    Ok(())
}

fn path(points: &[(f64, f64)], style: ShapeStyle) -> PathElement<(i32, i32)> {
    PathElement::new(points.iter().copied().map(pixels).collect::<Vec<_>>(), style)
}

/// Points on the lines between `points`.
fn along(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let between = |ends: &[(f64, f64)]| {
        let [(x, y), (to_x, to_y)] = [ends[0], ends[1]];
        let parts = (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
        parts.map(|part| (x + part * (to_x - x), y + part * (to_y - y))).collect::<Vec<_>>()
    };
    points.windows(2).flat_map(between).collect()
}

/// Grid, numbers and titles.
fn draw_axes(area: &Area<'_>, title: &str, across: &Scale, up: &Scale) -> Drawn {
    let faint = |pos| text(13.0, &FAINT_INK, FontStyle::Normal).pos(pos);
    let below = Pos::new(HPos::Center, VPos::Center);
    for tick in across.ticks() {
        let x = across.at(tick);
        area.draw(&PathElement::new([pixels((x, TOP)), pixels((x, BOTTOM))], GRID_INK))?;
        write(area, &number(tick), pixels((x, BOTTOM + 14.0)), faint(below))?;
    }
    let beside = Pos::new(HPos::Right, VPos::Center);
    for tick in up.ticks() {
        let y = up.at(tick);
        area.draw(&PathElement::new([pixels((LEFT, y)), pixels((RIGHT, y))], GRID_INK))?;
        write(area, &number(tick), pixels((LEFT - 8.0, y)), faint(beside))?;
    }
    let corners = [(LEFT, TOP), (LEFT, BOTTOM), (RIGHT, BOTTOM)].map(pixels);
    area.draw(&PathElement::new(corners, FAINT_INK))?;
    write(area, "bits per sample", (MARGIN, 14), text(14.0, &INK, FontStyle::Normal))?;
    let middle = pixels(((LEFT + RIGHT) / 2.0, BOTTOM + 38.0));
    write(area, title, middle, text(14.0, &INK, FontStyle::Normal).pos(below))
}

/// A dot and its label, with a line between them if they are apart.
fn draw_point(area: &Area<'_>, codec: &str, place: (f64, f64), label: &Rect) -> Drawn {
    let (colour, style) = if is_ours(codec) { (&OURS, FontStyle::Bold) } else { (&RIVAL, FontStyle::Normal) };
    let nearest = label.nearest(place);
    let apart = (nearest.0 - place.0).hypot(nearest.1 - place.1);
    if apart > 16.0 {
        area.draw(&PathElement::new([pixels(place), pixels(nearest)], RIVAL.stroke_width(1)))?;
    }
    area.draw(&Circle::new(pixels(place), 5, colour.filled()))?;
    let ink = if is_ours(codec) { &OURS } else { &INK };
    let middle = (label.top + label.bottom) / 2.0;
    let (x, side) = match place.0 {
        x if x < label.left => (label.left, HPos::Left),
        x if x > label.right => (label.right, HPos::Right),
        _ => ((label.left + label.right) / 2.0, HPos::Center),
    };
    write(area, codec, pixels((x, middle)), text(13.0, ink, style).pos(Pos::new(side, VPos::Center)))
}

/// The points that no other betters in size and speed at once, from the fastest to the smallest.
fn front<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<&'a Point> {
    let mut sorted: Vec<&Point> = points.collect();
    sorted.sort_by(|a, b| b.speed.total_cmp(&a.speed).then(a.size.total_cmp(&b.size)));
    let mut least = f64::MAX;
    sorted.retain(|point| {
        let better = point.size < least;
        least = least.min(point.size);
        better
    });
    sorted
}

/// A logarithmic axis.
struct Scale {
    low: f64,
    high: f64,
    /// Pixels of the ends.
    ends: [f64; 2],
}

impl Scale {
    /// From a little below the least figure to a little above the most.
    fn new(figures: impl Iterator<Item = f64>, start: f64, end: f64) -> Self {
        let (low, high) =
            figures.fold((f64::MAX, f64::MIN_POSITIVE), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (1.0, 1.0) };
        let room = (high / low).powf(0.06).max(1.05);
        Self { low: low / room, high: high * room, ends: [start, end] }
    }

    fn at(&self, figure: f64) -> f64 {
        let [start, end] = self.ends;
        start + (end - start) * (figure / self.low).ln() / (self.high / self.low).ln()
    }

    /// Round figures on the axis, no more than have room.
    fn ticks(&self) -> Vec<f64> {
        let fine = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let steps: [&[f64]; 3] = [&fine, &[1.0, 2.0, 5.0], &[1.0]];
        let ticks = |steps: &[f64]| {
            let decades = (-6..9).map(|power| 10_f64.powi(power));
            let figures: Vec<f64> =
                decades.flat_map(|decade| steps.iter().map(move |step| step * decade)).collect();
            figures.into_iter().filter(|tick| (self.low..self.high).contains(tick)).collect::<Vec<f64>>()
        };
        let apart =
            |ticks: &[f64]| ticks.windows(2).all(|two| (self.at(two[1]) - self.at(two[0])).abs() >= 22.0);
        steps.into_iter().map(ticks).find(|ticks| apart(ticks)).unwrap_or_default()
    }
}

/// A figure without needless digits.
fn number(figure: f64) -> String {
    let digits = format!("{figure:.6}");
    digits.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn pixels((x, y): (f64, f64)) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn write(area: &Area<'_>, text: &str, at: (i32, i32), style: TextStyle<'_>) -> Drawn {
    area.draw(&Text::new(text.to_owned(), at, style))
}

/// Text of so many pixels, to the right of its place and centred on its height.
fn text(size: f64, colour: &'static RGBColor, style: FontStyle) -> TextStyle<'static> {
    let font = FontDesc::new(FontFamily::SansSerif, size, style);
    TextStyle::from(font).color(colour).pos(Pos::new(HPos::Left, VPos::Center))
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    fn point(speed: f64, size: f64) -> Point {
        Point { codec: format!("{speed}"), speed, size }
    }

    #[test]
    fn the_front_has_what_nothing_betters() {
        let points = [point(1.0, 2.0), point(5.0, 4.0), point(2.0, 3.0), point(1.5, 3.5), point(5.0, 3.9)];
        let names: Vec<&str> = front(points.iter()).iter().map(|point| point.codec.as_str()).collect();
        assert_eq!(names, ["5", "2", "1"]);
        assert_eq!(front(points.iter())[0].size, 3.9);
    }

    #[test]
    fn axes_have_round_ticks_with_room_between() {
        let scale = Scale::new([0.5, 800.0].into_iter(), 0.0, 500.0);
        assert_eq!(scale.ticks(), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]);
        let narrow = Scale::new([3.1, 4.2].into_iter(), 500.0, 0.0);
        assert_eq!(narrow.ticks(), [3.0, 4.0]);
        assert!(Scale::new(std::iter::empty(), 0.0, 1.0).ticks().len() < 2);
        assert_eq!(["0.5", "20", "3"], [0.5, 20.0, 3.0].map(number));
    }

    #[test]
    fn every_codec_is_in_the_picture_twice() {
        let record = example();
        let picture = svg(&Summary::new(&record, "lossless"));
        for codec in ["wavelift default", "JPEG-LS", "pcodec"] {
            assert_eq!(picture.matches(&format!("\n{codec}\n")).count(), 2, "{codec}");
        }
        assert!(picture.trim_end().ends_with("</svg>"));
    }
}
