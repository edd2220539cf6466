//! The tables as a picture: for each wavelet how much of the raw size is left.
//!
//! Colours are from M. Okabe and K. Ito, *Color Universal Design*, 2008, chosen so that they differ in lightness too.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Row, Table};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const FAINT_INK: RGBColor = RGBColor(0x66, 0x66, 0x66);
const GRID_INK: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
const ORDER0: RGBColor = RGBColor(0x9a, 0xd1, 0xf2);
const STREAM: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const REFERENCE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);

/// Lengths in pixels.
const PANEL_WIDTH: u32 = 600;
const HEADER_HEIGHT: u32 = 96;
const FOOTER_HEIGHT: u32 = 80;
const PANEL_TITLE_HEIGHT: i32 = 56;
const AXIS_HEIGHT: i32 = 56;
const ROW_HEIGHT: i32 = 58;
const BAR_HEIGHT: i32 = 19;
const LEFT: i32 = 132;
const RIGHT: i32 = 64;
const MARGIN: i32 = 24;

/// Letters of a title that fit into the width of a panel.
const TITLE_LETTERS: usize = 48;

/// Draws a panel a table, side by side, and returns the picture as SVG.
pub fn svg(tables: &[Table]) -> String {
    let rows = tables.iter().map(|table| table.rows.len()).max().unwrap_or(0) as i32;
    let panel_height = PANEL_TITLE_HEIGHT + rows * ROW_HEIGHT + AXIS_HEIGHT;
    let width = PANEL_WIDTH * tables.len().max(1) as u32;
    let height = HEADER_HEIGHT + panel_height as u32 + FOOTER_HEIGHT;
    let mut picture = String::new();
    let root = SVGBackend::with_string(&mut picture, (width, height)).into_drawing_area();
    draw(&root, tables).expect("drawing into memory does not fail");
    drop(root);
    picture
}

fn draw(root: &Area<'_>, tables: &[Table]) -> Drawn {
    root.fill(&WHITE)?;
    let (header, body) = root.split_vertically(HEADER_HEIGHT);
    let has_reference = tables.iter().any(|table| table.reference.is_some());
    draw_header(&header, has_reference)?;
    let (_, body_height) = body.dim_in_pixel();
    let (body, footer) = body.split_vertically(body_height - FOOTER_HEIGHT);
    for (panel, table) in body.split_evenly((1, tables.len().max(1))).iter().zip(tables) {
        draw_panel(panel, table)?;
    }
    draw_footer(&footer, has_reference)?;
    root.present()
}

fn draw_header(area: &Area<'_>, has_reference: bool) -> Drawn {
    write(area, "Lossless compression by wavelet", (MARGIN, 34), bold(24.0, &INK))?;
    let mut x = MARGIN;
    for (colour, label, width) in
        [(ORDER0, "order-0 code length", 190), (STREAM, "codestream as written", 206)]
    {
        area.draw(&Rectangle::new([(x, 61), (x + 16, 77)], colour.filled()))?;
        write(area, label, (x + 24, 69), plain(15.0, &INK))?;
        x += width;
    }
    if has_reference {
        area.draw(&Rectangle::new([(x + 6, 58), (x + 9, 80)], REFERENCE.filled()))?;
        let label = "order-0 code length in the dissertation";
        write(area, label, (x + 20, 69), plain(15.0, &INK))?;
    }
    Ok(())
}

fn draw_footer(area: &Area<'_>, has_reference: bool) -> Drawn {
    let notes = [
        "Order-0: code length of the histogram of all coefficients, not counting itself.",
        "Codestream: as written, headers included; decoded again and compared bit for bit.",
        "Dissertation: M. Bertram, Multiresolution Modeling for Scientific Visualization, 2000, Tables 3.5 and 3.6; \
         another simulation of the same kind.",
    ];
    for (note, y) in notes.iter().take(if has_reference { 3 } else { 2 }).zip((14..).step_by(21)) {
        write(area, note, (MARGIN, y), plain(13.0, &FAINT_INK))?;
    }
    Ok(())
}

fn draw_panel(area: &Area<'_>, table: &Table) -> Drawn {
    write(area, &shortened(&table.title), (MARGIN, 12), bold(17.0, &INK))?;
    write(area, &table.description(), (MARGIN, 34), plain(13.0, &FAINT_INK))?;
    let scale = Scale::of(table);
    let bottom = PANEL_TITLE_HEIGHT + ROW_HEIGHT * table.rows.len() as i32;
    for percent in scale.ticks() {
        let x = scale.x(f64::from(percent));
        area.draw(&PathElement::new([(x, PANEL_TITLE_HEIGHT), (x, bottom)], GRID_INK))?;
        write(area, &percent.to_string(), (x, bottom + 14), plain(13.0, &FAINT_INK).pos(CENTRE))?;
    }
    let middle = (LEFT + PANEL_WIDTH as i32 - RIGHT) / 2;
    write(area, "percent of the samples' bytes", (middle, bottom + 36), plain(13.0, &FAINT_INK).pos(CENTRE))?;
    for (row, top) in table.rows.iter().zip((PANEL_TITLE_HEIGHT..).step_by(ROW_HEIGHT as usize)) {
        draw_row(area, table, row, (&scale, top + (ROW_HEIGHT - 2 * BAR_HEIGHT) / 2))?;
    }
    let axis = scale.x(0.0);
    area.draw(&PathElement::new([(axis, PANEL_TITLE_HEIGHT), (axis, bottom)], INK))
}

/// Two bars with their values, the label to their left, and the text's figure across the first.
fn draw_row(area: &Area<'_>, table: &Table, row: &Row, (scale, top): (&Scale, i32)) -> Drawn {
    let right = Pos::new(HPos::Right, VPos::Center);
    let (name_y, symbol_y) = (top + BAR_HEIGHT - 8, top + BAR_HEIGHT + 10);
    write(area, row.name(), (LEFT - 12, name_y), plain(15.0, &INK).pos(right))?;
    let symbol = row.wavelet.map_or("no transform", |wavelet| wavelet.symbol()).replace("psi", "ψ");
    write(area, &symbol, (LEFT - 12, symbol_y), plain(12.0, &FAINT_INK).pos(right))?;

    let is_best = table.best().is_some_and(|best| best.stream_bytes == row.stream_bytes);
    let reference = table.reference_percent(row).map(|percent| scale.x(percent));
    let order0 = f64::from(row.measure.percent_of(table.raw_bytes()));
    let bars = [
        (order0, ORDER0, reference, plain(13.0, &FAINT_INK)),
        (table.stream_percent(row), STREAM, None, if is_best { bold(13.0, &INK) } else { plain(13.0, &INK) }),
    ];
    for ((percent, colour, mark, style), top) in bars.into_iter().zip([top, top + BAR_HEIGHT]) {
        let end = scale.x(percent);
        area.draw(&Rectangle::new([(scale.x(0.0), top), (end, top + BAR_HEIGHT - 1)], colour.filled()))?;
        if let Some(x) = mark {
            area.draw(&Rectangle::new(
                [(x - 1, top - 3), (x + 2, top + BAR_HEIGHT + 1)],
                REFERENCE.filled(),
            ))?;
        }
        let (x, y) = (end.max(mark.unwrap_or(end)) + 7, top + BAR_HEIGHT / 2);
        let value = format!("{percent:.1}");
        // No line of the grid runs through a number.
        let patch = [(x - 2, y - 7), (x + 9 * value.len() as i32, y + 7)];
        area.draw(&Rectangle::new(patch, WHITE.filled()))?;
        write(area, &value, (x, y), style)?;
    }
    Ok(())
}

/// As much of a title as a panel has room for.
fn shortened(title: &str) -> String {
    match title.char_indices().nth(TITLE_LETTERS) {
        Some((end, _)) => format!("{}…", &title[..end]),
        None => title.to_owned(),
    }
}

/// From percent to pixels of a panel.
struct Scale {
    /// The last tick, in percent.
    end: u32,
    step: u32,
}

impl Scale {
    /// A scale with room for every figure of a table.
    fn of(table: &Table) -> Self {
        let figures = table.rows.iter().flat_map(|row| {
            let order0 = f64::from(row.measure.percent_of(table.raw_bytes()));
            [order0, table.stream_percent(row), table.reference_percent(row).unwrap_or(0.0)]
        });
        let most = figures.fold(1.0, f64::max).min(1e6).ceil() as u32;
        let step = [1, 2, 5, 10, 20, 50, 100].into_iter().find(|step| most.div_ceil(*step) <= 8);
        let step = step.unwrap_or(most.div_ceil(8));
        Self { end: most.div_ceil(step) * step, step }
    }

    fn ticks(&self) -> impl Iterator<Item = u32> + use<> {
        (0..=self.end).step_by(self.step as usize)
    }

    fn x(&self, percent: f64) -> i32 {
        let width = PANEL_WIDTH as i32 - RIGHT - LEFT;
        LEFT + (f64::from(width) * percent / f64::from(self.end)).round() as i32
    }
}

const CENTRE: Pos = Pos { h_pos: HPos::Center, v_pos: VPos::Center };

fn write(area: &Area<'_>, text: &str, at: (i32, i32), style: TextStyle<'_>) -> Drawn {
    area.draw(&Text::new(text.to_owned(), at, style))
}

/// Text of so many pixels, to the right of its place and centred on its height.
fn plain(size: f64, colour: &'static RGBColor) -> TextStyle<'static> {
    styled(size, colour, FontStyle::Normal)
}

fn bold(size: f64, colour: &'static RGBColor) -> TextStyle<'static> {
    styled(size, colour, FontStyle::Bold)
}

fn styled(size: f64, colour: &'static RGBColor, style: FontStyle) -> TextStyle<'static> {
    let font = FontDesc::new(FontFamily::SansSerif, size, style);
    TextStyle::from(font).color(colour).pos(Pos::new(HPos::Left, VPos::Center))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::example;

    #[test]
    fn every_figure_and_name_is_in_the_picture() {
        let table = example();
        let picture = svg(std::slice::from_ref(&table));
        assert!(picture.starts_with("<svg width=\"600\""), "{}", &picture[..60]);
        assert!(picture.contains("a &lt;line&gt; &amp; more"));
        for row in &table.rows {
            assert!(picture.contains(row.name()));
            assert!(picture.contains(&format!("{:.1}\n", table.stream_percent(row))));
        }
        assert!(picture.trim_end().ends_with("</svg>"));
        assert!(svg(&[table.clone(), table]).starts_with("<svg width=\"1200\""));
    }

    #[test]
    fn scales_end_at_a_tick_beyond_every_figure() {
        let mut table = example();
        table.reference = None;
        let order0 = table.rows[0].measure.percent_of(table.raw_bytes());
        assert!(order0 < 20.0, "{order0}");
        for (bytes, end, step) in [(8, 50, 10), (12, 80, 10), (16, 100, 20), (17, 120, 20), (80, 500, 100)] {
            table.rows[0].stream_bytes = bytes;
            table.rows.truncate(1);
            let scale = Scale::of(&table);
            assert_eq!((scale.end, scale.step), (end, step), "{bytes}");
            assert_eq!(scale.x(f64::from(end)), PANEL_WIDTH as i32 - RIGHT);
        }
    }

    #[test]
    fn no_tables_make_an_empty_picture() {
        assert!(svg(&[]).contains("Lossless compression"));
    }
}
