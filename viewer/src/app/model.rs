//! What the parts of the application know → what the user interface shows.

use std::array;

use super::App;
use crate::ui::model::{FileShown, Genes, Model, Situation, Stats, ViewModel, ViewState};
use crate::upload::AssetBuffers;

impl App {
    /// Fills the model for one frame.
    pub(super) fn model(&self) -> Model {
        let (editor, settings) = (&self.editor, &self.file.settings);
        let viewports = self.live.as_ref().map(|live| &live.viewports);
        let (generation, generations) = editor.generations();
        let views = array::from_fn(|view| {
            let own_name = || {
                viewports
                    .and_then(|viewports| viewports.exhibit(view))
                    .map(|exhibit| exhibit.name().to_owned())
            };
            ViewModel {
                descent: editor.descent(view).to_owned(),
                name: editor.name(view).map(str::to_owned).or_else(own_name).unwrap_or_default(),
                picture: viewports.and_then(|viewports| viewports.picture(view)),
                state: editor.state(view),
            }
        });
        Model {
            situation: self.situation(&views),
            generation,
            generations: generations.to_vec(),
            baking: editor.bake.baking.clone(),
            undo: editor.next_undo(),
            redo: editor.next_redo(),
            views,
            ballots: editor.ballots,
            arrangement: self.layout.arrangement,
            chosen: self.layout.chosen,
            genes: editor.genes().map(|genes| Genes { taught: self.taught.of(generation), ..genes }),
            bake_log: editor.bake.log.clone(),
            errors: editor.errors(),
            stats: viewports.map_or_else(Stats::default, |viewports| viewports.stats().clone()),
            bindings: self.bindings.clone(),
            count: editor.count(),
            votable: editor.world().is_some() && self.cli.answers.is_none(),
            studied: self.cli.answers.is_some(),
            file: viewports
                .and_then(|viewports| viewports.exhibit(0)?.asset())
                .map(|asset| file_shown(asset)),
            parents: editor.parents().clone(),
            ancestors: editor.ancestors().cloned(),
            variety: editor.variety(),
            answers: self.answers.clone(),
            family: editor.family(),
            favourites: editor.favourites().clone(),
            thumbnails: self.thumbnails.shown(),
            greets: !settings.greeted,
            options: settings.options,
            comfort: settings.comfort.value,
            export: self.exports.model(&settings.export.value, &self.source),
            panels: self.layout.panels,
            captured: self.camera.captured(),
        }
    }

    fn situation(&self, views: &[ViewModel]) -> Situation {
        let editor = &self.editor;
        // A landscape gets its picture in the first frame that has a place for it.
        if self
            .live
            .as_ref()
            .is_some_and(|live| (0..views.len()).any(|view| live.viewports.exhibit(view).is_some()))
        {
            return Situation::Ready;
        }
        let own = &views[..editor.count()];
        let failed = own.iter().all(|view| matches!(view.state, ViewState::Failed { .. }));
        if let (true, Some(error)) = (failed || editor.is_hindered(), editor.errors().first()) {
            return Situation::Stuck {
                title: "Nothing to show".to_owned(),
                what: error.report.clone(),
                remedy: match editor.world() {
                    Some(_) => "Mend what the message names, or drop another world's folder here.",
                    None => "Drop another file here, a world or a baked folder.",
                }
                .to_owned(),
            };
        }
        if editor.world().is_some() && self.background.baker.is_none() && editor.generations().1.is_empty() {
            return Situation::Stuck {
                title: "No landscapes yet".to_owned(),
                what: "The world is empty, and this viewer was started with --no-bake.".to_owned(),
                remedy: "Run `bake --watch` with the same --world, or start the viewer without --no-bake."
                    .to_owned(),
            };
        }
        Situation::Growing
    }
}

fn file_shown(asset: &AssetBuffers) -> FileShown {
    let [low, high] = asset.bounds_m;
    FileShown {
        name: asset.name.clone(),
        facts: asset.facts.clone(),
        size_m: (high - low).to_array(),
        cell_m: asset.staging.cell_m / asset.staging.scale as f32,
    }
}
