//! How fast errors fall.

use super::text;
use crate::report::{Cell, Measured, Measurement, Report, Trial, plot};

pub struct Plot {
    pub title: String,
    pub svg: String,
    /// Colour, name, exponent if it is known.
    pub legend: Vec<(usize, String, String)>,
}

/// An integrator with all its samplers, and the numbers of their colours.
struct Panel<'a> {
    trial: &'a Trial,
    cells: Vec<(usize, &'a Cell, &'a Measurement)>,
}

impl<'a> Panel<'a> {
    fn new(trial: &'a Trial, report: &Report) -> Option<Panel<'a>> {
        let tried = trial.tried()?;
        let cells = tried.cells.iter().filter_map(|cell| {
            let colour = report.samplers.iter().position(|name| *name == cell.sampler)?;
            Some((colour, cell, cell.outcome.as_ref().ok()?))
        });
        Some(Panel {
            trial,
            cells: cells.collect(),
        })
    }

    fn curves(&self) -> Vec<plot::Curve<'a>> {
        let curve = |&(colour, _, measurement): &(usize, &'a Cell, &'a Measurement)| plot::Curve {
            colour,
            levels: &measurement.levels,
        };
        self.cells.iter().map(curve).collect()
    }

    fn plot(&self, spp: u32, bounds: (f64, f64)) -> Plot {
        let legend = self.cells.iter().map(|(colour, cell, measurement)| {
            let slope = measurement.slope.map_or(String::new(), text::exponent);
            (*colour, cell.sampler.clone(), slope)
        });
        Plot {
            title: self.trial.integrator.clone(),
            svg: plot::convergence(&self.curves(), spp, bounds),
            legend: legend.collect(),
        }
    }
}

/// A plot for each integrator, on the same scale within a kind of light.
pub fn convergence(measured: &Measured, report: &Report) -> Vec<Plot> {
    let of_group = measured.groups.iter().flat_map(|group| {
        let panels = group.trials.iter().filter_map(|trial| Panel::new(trial, report));
        let panels: Vec<Panel> = panels.collect();
        let curves: Vec<plot::Curve> = panels.iter().flat_map(Panel::curves).collect();
        let bounds = plot::bounds(&curves);
        let plots = panels
            .into_iter()
            .filter_map(|panel| Some(panel.plot(report.spp, bounds?)));
        plots.collect::<Vec<_>>()
    });
    of_group.collect()
}
