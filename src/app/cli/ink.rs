//! Arguments of drawings.

use clap::Args;

use crate::ink::paper::style::{PaperStyle, paper_size};
use crate::ink::paper::svg::Profile;
use crate::ink::shown::InkView;
use crate::{Error, Result};

/// How `render` draws in pen and ink.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Pen and ink")]
pub struct InkArgs {
    /// Draws instead of showing a view: full, half, leaves, minimal, mixed, normal-edges,
    /// normal-edges-original, outline, photo, pointillist, silhouette-hatching, smooth, toon,
    /// van-gogh, watercolour, or a style or mix file (.toml). On paper, also as vectors (.svg, .pdf):
    /// ds00-fig2, ds00-fig3a, ds00-fig3b, ds00-fig4a, ds00-fig4b, ds00-fig4c, ds00-fig5, ds00-fig5b,
    /// ds00-fig6a, ds00-fig6b, ds00-fig6c, ds00-fig6d, ds00-fig6e, ds00-fig6f, crown-hatching,
    /// coloured-pens, lenient-sketch, plotter-a4, or a file with kind = "paper"
    #[arg(long, value_name = "STYLE|FILE", conflicts_with_all = ["view", "compare", "lighting"])]
    pub style: Option<String>,
    /// A second style: with --share, what lies between the two
    #[arg(long, value_name = "STYLE|FILE")]
    pub toward: Option<String>,
    /// How far towards it, 0 to 1; several stand side by side
    #[arg(
        long,
        value_name = "SHARE",
        value_delimiter = ',',
        default_value = "0.5",
        requires = "toward"
    )]
    pub share: Vec<f32>,
    /// Shows one attribute instead of the drawing: albedo, normal, depth, object, cluster, direction,
    /// hatch, tone, shadow, contour, silhouette, edges or wash
    #[arg(long, value_name = "ATTRIBUTE")]
    pub ink_view: Option<InkView>,
    /// Pixels drawn for one of the picture, along each axis, 1 to 4; 1 is the paper's
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub ink_supersample: u32,
    /// Paper of drawings, millimetres: a6 to a0, letter, tabloid (with -landscape: turned), or
    /// width x height
    #[arg(long, value_name = "SIZE", value_parser = paper_size)]
    pub paper: Option<[f64; 2]>,
    /// How vectors are written: centre lines in a plotter's order, filled outlines for print, or a
    /// group for every primitive
    #[arg(long, value_name = "plotter|print|edit", value_parser = profile)]
    pub profile: Option<Profile>,
}

fn profile(text: &str) -> std::result::Result<Profile, String> {
    match text {
        "plotter" => Ok(Profile::Plotter),
        "print" => Ok(Profile::Print),
        "edit" => Ok(Profile::Edit),
        _ => Err("expected plotter, print or edit".into()),
    }
}

impl InkArgs {
    /// Sees that options of drawings stand beside a style. A drawing that is drawn again has one.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check_style(&self) -> Result<()> {
        let given = [
            ("toward", self.toward.is_some()),
            ("ink-view", self.ink_view.is_some()),
            ("paper", self.paper.is_some()),
            ("profile", self.profile.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((name, _)) if self.style.is_none() => Err(Error::usage(format!(
                "--{name}: needs a drawing: a --style, or a drawing (.svg) to draw again"
            ))),
            _ => Ok(()),
        }
    }

    /// Sees that no option of pictures in real time stands beside a style on paper.
    ///
    /// # Errors
    /// The first that does.
    pub fn check_paper(&self) -> Result<()> {
        let given = [
            ("toward", self.toward.is_some()),
            ("ink-view", self.ink_view.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(Error::usage(format!(
                "--{name}: for styles of pictures in real time; drawings on paper have it not"
            ))),
            None => Ok(()),
        }
    }

    /// Changes a style to what the command line says.
    ///
    /// # Errors
    /// A style that no longer holds together.
    pub fn change(&self, style: &mut PaperStyle) -> Result<()> {
        if let Some(paper) = self.paper {
            style.sheet.paper = paper;
        }
        if let Some(profile) = self.profile {
            style.sheet.profile = profile;
        }
        style.check().map_err(Error::usage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::{paper, style};

    #[test]
    fn the_help_names_every_style() {
        let command = InkArgs::augment_args(clap::Command::new("render"));
        let argument = command.get_arguments().find(|a| a.get_id() == "style");
        let help = argument.and_then(clap::Arg::get_help).unwrap().to_string();
        let said: Vec<&str> = help
            .split(|c: char| !c.is_alphanumeric() && c != '-')
            .collect();
        let all = style::PRESETS.iter().chain(&paper::presets::PRESETS);
        for (name, _) in all {
            assert!(said.contains(name), "{name}: {help}");
        }
    }
}
