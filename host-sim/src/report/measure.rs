//! Renders what was asked for and takes the numbers.

use std::sync::atomic::AtomicBool;

use super::stat::{Average, Estimate, mean_light, shrunk, slope};
use super::work::{Work, levels};
use super::{
    Against, BATCHES, Cell, Group, Level, Measured, Measurement, Report, Request, SceneReport, Shot, Subject,
    Trial, Tried, Truth, group,
};
use crate::desc::{IntegratorKind, SamplerKind};
use crate::metrics::{Metrics, MetricsError, difference_colours, rmse};
use crate::picture::{Picture, display_pixels};
use crate::run::{self, Error, Options, Progress, Stats};

/// Samples a pixel at which samplers are shown beside each other.
const ROUGH: u32 = 4;

/// All of it; the one error that ends it is to be stopped.
pub fn measure(request: &Request, progress: &dyn Progress, cancel: &AtomicBool) -> Result<Report, Error> {
    let groups = grouped(request);
    let work = Work::new(request, groups.len(), progress);
    let mut scenes = Vec::new();
    for subject in &request.scenes {
        let began = work.done();
        let bench = Bench {
            request,
            subject,
            work: &work,
            cancel,
        };
        scenes.push(SceneReport {
            name: subject.desc.name.clone(),
            outcome: excused(bench.scene(&groups))?.map(Box::new),
        });
        work.skip_rest(request, subject, groups.len(), began);
    }
    Ok(Report {
        spp: request.spp,
        reference_spp: request.reference_spp,
        batch_spp: request.batch_spp(),
        seed: request.scenes.first().map_or(0, |subject| subject.options.seed),
        integrators: request.integrators.iter().map(|(name, _)| name.clone()).collect(),
        samplers: request.samplers.iter().map(|(name, _)| name.clone()).collect(),
        scenes,
    })
}

type Member<'a> = &'a (String, IntegratorKind);

/// Integrators by the light they look for, in the order they were asked for.
fn grouped(request: &Request) -> Vec<Vec<Member<'_>>> {
    let mut groups: Vec<Vec<Member>> = Vec::new();
    for member in &request.integrators {
        let same = |g: &&mut Vec<Member>| group::of(g[0].1) == group::of(member.1);
        match groups.iter_mut().find(same) {
            Some(group) => group.push(member),
            None => groups.push(vec![member]),
        }
    }
    groups
}

/// What a scene cannot do is told on the page and stops nothing else.
fn excused<T>(result: Result<T, Error>) -> Result<Result<T, String>, Error> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(Error::Scene(reason)) => Ok(Err(reason)),
        Err(stop @ Error::Cancelled) => Err(stop),
    }
}

/// Two renders of the reference, and what is known from them.
struct Twins {
    first: Picture,
    mean: Picture,
    /// Mean squared noise of `mean`.
    noise: f64,
    light: Estimate,
    stats: Stats,
}

/// A scene at work.
struct Bench<'a> {
    request: &'a Request,
    subject: &'a Subject,
    work: &'a Work<'a>,
    cancel: &'a AtomicBool,
}

impl Bench<'_> {
    fn scene(&self, groups: &[Vec<Member>]) -> Result<Measured, Error> {
        let Subject { desc, options, .. } = self.subject;
        let info = run::describe(desc, options)?;
        let primary = {
            let _part = self.work.primary();
            run::compare_primary_rays(desc, options, self.cancel)?
        };
        let (elsewhere, elsewhere_left_out) = match self.elsewhere() {
            Some(Ok(picture)) => (Some(picture), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        // The light that the scene itself asks for comes first.
        let own = group::of(desc.integrator.kind);
        let (mut sorted, others): (Vec<_>, Vec<_>) =
            groups.iter().partition(|members| group::of(members[0].1) == own);
        sorted.extend(others);
        let groups = sorted
            .into_iter()
            .map(|members| {
                let looks_for_it = group::of(members[0].1) == own;
                self.group(members, elsewhere.as_ref().filter(|_| looks_for_it))
            })
            .collect::<Result<_, _>>()?;
        Ok(Measured {
            options: Options {
                spp: self.request.spp,
                ..options.clone()
            },
            info,
            primary,
            groups,
            elsewhere_left_out,
        })
    }

    /// The picture made elsewhere in the size of the others, or why that cannot be.
    fn elsewhere(&self) -> Option<Result<Picture, String>> {
        let options = &self.subject.options;
        let found = self.subject.elsewhere.as_ref()?;
        let fitting = shrunk(&found.picture, options.width as usize, options.height as usize);
        Some(fitting.ok_or_else(|| {
            format!(
                "{} has {} x {} pixels, no multiple of {} x {}",
                found.file, found.picture.width, found.picture.height, options.width, options.height
            )
        }))
    }

    fn group(&self, members: &[Member], elsewhere: Option<&Picture>) -> Result<Group, Error> {
        let twins = excused(self.reference(members))?;
        let known = twins.as_ref().ok();
        let stops = known.map_or(0.0, |twins| stops(&twins.mean));
        let trials = members
            .iter()
            .map(|(name, kind)| {
                let desc = &self.subject.desc;
                Ok(Trial {
                    integrator: name.clone(),
                    caveat: group::caveat(*kind, desc),
                    outcome: excused(self.integrator(*kind, known, elsewhere, stops))?,
                })
            })
            .collect::<Result<_, Error>>()?;
        let truth = match twins {
            Ok(twins) => Ok(Truth {
                against: elsewhere
                    .map(|other| against(&twins.first, twins.light, &twins.mean, other))
                    .transpose()?,
                shot: Shot::of(&twins.mean, stops),
                light: twins.light,
                noise: twins.noise.sqrt(),
                stats: twins.stats,
            }),
            Err(reason) => Err(reason),
        };
        Ok(Group {
            title: group::title(group::of(members[0].1)).to_string(),
            truth,
            elsewhere: elsewhere.map(|picture| Shot::of(picture, stops)),
            stops,
            trials,
        })
    }

    /// The reference twice, with two seeds.
    fn reference(&self, members: &[Member]) -> Result<Twins, Error> {
        let integrator = group::of(members[0].1);
        let spp = self.request.reference_spp;
        let render = |seed: u32| {
            let options = Options {
                spp,
                integrator,
                seed: self.subject.options.seed.wrapping_add(seed),
                ..self.subject.options.clone()
            };
            let part = self.work.reference(self.subject, spp);
            run::render_reference(&self.subject.desc, &options, &part, self.cancel)
        };
        let (first, stats) = render(0)?;
        let (second, _) = render(1)?;
        let mut mean = Average::default();
        mean.add(&first, 1.0);
        mean.add(&second, 1.0);
        Ok(Twins {
            mean: mean.picture(),
            noise: rmse(&first, &second).map_err(broken)?.powi(2) / 4.0,
            light: Estimate::of_twins(&first, &second),
            first,
            stats,
        })
    }

    fn fixed(
        &self,
        integrator: IntegratorKind,
        sampler: SamplerKind,
        spp: u32,
        seed: u32,
    ) -> Result<(Picture, Stats), Error> {
        let options = self.options(integrator, sampler, spp, seed);
        let part = self.work.fixed(self.subject, spp);
        run::render_fixed(&self.subject.desc, &options, &part, self.cancel)
    }

    fn options(&self, integrator: IntegratorKind, sampler: SamplerKind, spp: u32, seed: u32) -> Options {
        Options {
            spp,
            integrator,
            sampler,
            seed: self.subject.options.seed.wrapping_add(seed),
            ..self.subject.options.clone()
        }
    }

    /// An integrator with every sampler; with one of them more closely.
    fn integrator(
        &self,
        kind: IntegratorKind,
        twins: Option<&Twins>,
        elsewhere: Option<&Picture>,
        stops: f64,
    ) -> Result<Tried, Error> {
        let samplers = &self.request.samplers;
        let main = samplers.iter().find(|(_, s)| *s == self.subject.options.sampler);
        let (main_name, main) = main.unwrap_or(&samplers[0]);
        let spp = self.request.spp;
        let info = run::describe(&self.subject.desc, &self.options(kind, *main, spp, 0))?;

        // What the integrator says in the mean, by renders that share no random number.
        let batch_spp = self.request.batch_spp();
        let mut average = Average::default();
        let mut lights = Vec::new();
        for seed in 1..=BATCHES {
            let (picture, _) = self.fixed(kind, *main, batch_spp, seed)?;
            lights.push(mean_light(&picture));
            average.add(&picture, f64::from(batch_spp));
        }
        let light = Estimate::of(&lights);

        let mut cells = Vec::new();
        let mut judged = None;
        for (name, sampler) in samplers {
            let made = excused(self.cell(kind, *sampler, twins, stops))?;
            let outcome = made.map(|(picture, measurement)| {
                if sampler == main {
                    average.add(&picture, f64::from(spp));
                    judged = Some(picture);
                }
                measurement
            });
            cells.push(Cell {
                sampler: name.clone(),
                outcome,
            });
        }
        let picture = average.picture();
        let differs = |twins: &Twins| Shot::difference(&picture, &twins.mean);
        Ok(Tried {
            ram_bytes: info.ram_bytes(),
            sampler: main_name.clone(),
            shot_spp: BATCHES * batch_spp + judged.as_ref().map_or(0, |_| spp),
            difference: twins.map(differs).transpose()?,
            bias: twins.and_then(|twins| light.relative_to(twins.light)),
            against: elsewhere
                .map(|other| against(judged.as_ref().unwrap_or(&picture), light, &picture, other))
                .transpose()?,
            shot: Shot::of(&picture, stops),
            cells,
        })
    }

    /// One integrator with one sampler, at ever more samples; the picture is the last.
    fn cell(
        &self,
        integrator: IntegratorKind,
        sampler: SamplerKind,
        twins: Option<&Twins>,
        stops: f64,
    ) -> Result<(Picture, Measurement), Error> {
        let spp_levels = levels(self.request.spp);
        let rough_at = spp_levels.iter().copied().filter(|&n| n <= ROUGH).max();
        let mut seen = Vec::new();
        let mut rough = None;
        let mut last = None;
        for spp in spp_levels {
            let (picture, stats) = self.fixed(integrator, sampler, spp, 0)?;
            if let Some(twins) = twins {
                seen.push(level(spp, &picture, twins)?);
            }
            if rough_at == Some(spp) {
                rough = Some((spp, Shot::of(&picture, stops)));
            }
            last = Some((picture, stats));
        }
        let (picture, stats) = last.ok_or_else(|| Error::Scene("no samples were asked for".to_string()))?;
        let metrics = twins
            .map(|twins| Metrics::of(&picture, &twins.first).map_err(broken))
            .transpose()?;
        let points: Vec<(f64, f64)> = seen
            .iter()
            .filter_map(|level| Some((f64::from(level.spp), level.rmse?)))
            .collect();
        let measurement = Measurement {
            stats,
            metrics,
            slope: slope(&points),
            levels: seen,
            rough,
        };
        Ok((picture, measurement))
    }
}

/// Error of a picture against the truth. What the truth's own noise adds to the mean square is known and taken off,
/// unless it is more than half.
fn level(spp: u32, picture: &Picture, twins: &Twins) -> Result<Level, Error> {
    let seen = rmse(picture, &twins.mean).map_err(broken)?.powi(2);
    let rmse = (seen > 2.0 * twins.noise).then(|| (seen - twins.noise).sqrt());
    Ok(Level { spp, rmse })
}

/// Numbers of `judged`, colours and light of what is known best, against a picture made elsewhere.
fn against(judged: &Picture, light: Estimate, best: &Picture, other: &Picture) -> Result<Against, Error> {
    let exact = Estimate {
        value: mean_light(other),
        standard_error: 0.0,
    };
    Ok(Against {
        metrics: Metrics::of(judged, other).map_err(broken)?,
        bias: light.relative_to(exact),
        difference: Shot::difference(best, other)?,
    })
}

/// A picture that cannot be compared with its reference: not the user's fault.
fn broken(error: MetricsError) -> Error {
    Error::Scene(error.to_string())
}

/// Whole stops by which a picture is shown brighter or darker so that something can be seen of it: its light, each pixel
/// counted up to white, is to be a middle grey about.
fn stops(picture: &Picture) -> f64 {
    const GREY: f64 = 0.2;
    const MOST: f64 = 5.0;
    let light = picture.rgb.as_flattened().iter().map(|&x| f64::from(x).min(1.0));
    let mean = light.sum::<f64>() / (3 * picture.rgb.len()).max(1) as f64;
    if mean > 0.0 {
        (GREY / mean).log2().trunc().clamp(-MOST, MOST)
    } else {
        0.0
    }
}

impl Shot {
    pub(super) fn of(picture: &Picture, stops: f64) -> Shot {
        Shot {
            width: picture.width,
            height: picture.height,
            pixels: display_pixels(picture, stops),
        }
    }

    fn difference(picture: &Picture, truth: &Picture) -> Result<Shot, Error> {
        Ok(Shot {
            width: picture.width,
            height: picture.height,
            pixels: difference_colours(picture, truth).map_err(broken)?,
        })
    }
}
