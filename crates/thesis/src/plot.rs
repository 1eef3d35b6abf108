//! Curves as SVG.

use plotters::prelude::*;

/// Curves over common axes, both logarithmic.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Above the curves.
    pub title: String,
    /// What the horizontal axis counts.
    pub x: String,
    /// What the vertical axis measures.
    pub y: String,
    /// Every curve by its name; points with positive coordinates.
    pub curves: Vec<(String, Vec<(f64, f64)>)>,
}

/// Why a plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the plot '{title}' could not be drawn: {reason}")]
pub struct PlotError {
    title: String,
    reason: String,
}

const SIZE: (u32, u32) = (800, 520);

impl Plot {
    /// The plot as an SVG document.
    ///
    /// # Errors
    /// If the back end fails; a plot without points gives an empty frame.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let mut text = String::new();
        let failed = |reason: String| PlotError { title: self.title.clone(), reason };
        self.draw(&mut text).map_err(failed)?;
        Ok(text)
    }

    fn draw(&self, text: &mut String) -> Result<(), String> {
        let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
        let reason = |error: &dyn std::fmt::Display| error.to_string();
        area.fill(&WHITE).map_err(|e| reason(&e))?;
        let points = || self.curves.iter().flat_map(|(_, points)| points);
        let bounds = |coordinate: fn(&(f64, f64)) -> f64| {
            let values = || points().map(coordinate).filter(|value| *value > 0.0);
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(0.0, f64::max);
            if low.is_finite() { (low / 1.5)..(high * 1.5) } else { 0.1..10.0 }
        };
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, ("sans-serif", 20))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(bounds(|p| p.0).log_scale(), bounds(|p| p.1).log_scale())
            .map_err(|e| reason(&e))?;
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .light_line_style(WHITE.mix(0.0))
            .draw()
            .map_err(|e| reason(&e))?;
        for (number, (name, points)) in self.curves.iter().enumerate() {
            let color = Palette99::pick(number).to_rgba();
            let line = LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(3);
            chart
                .draw_series(line)
                .map_err(|e| reason(&e))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()
            .map_err(|e| reason(&e))?;
        area.present().map_err(|e| reason(&e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_names_its_curves() {
        let plot = Plot {
            title: "bush".into(),
            x: "objects".into(),
            y: "seconds".into(),
            curves: vec![("cpu".into(), vec![(7.0, 0.1), (841.0, 0.3)]), ("none".into(), vec![])],
        };
        let svg = plot.to_svg().unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("bush") && svg.contains("cpu"), "{svg}");
    }
}
