//! Built-in styles of drawings on paper: figures of Deussen and Strothotte 2000, and our own.

/// Built-in styles: name and file.
pub const PRESETS: [(&str, &str); 18] = [
    ("ds00-fig2", include_str!("presets/ds00-fig2.toml")),
    ("ds00-fig3a", include_str!("presets/ds00-fig3a.toml")),
    ("ds00-fig3b", include_str!("presets/ds00-fig3b.toml")),
    ("ds00-fig4a", include_str!("presets/ds00-fig4a.toml")),
    ("ds00-fig4b", include_str!("presets/ds00-fig4b.toml")),
    ("ds00-fig4c", include_str!("presets/ds00-fig4c.toml")),
    ("ds00-fig5", include_str!("presets/ds00-fig5.toml")),
    ("ds00-fig5b", include_str!("presets/ds00-fig5b.toml")),
    ("ds00-fig6a", include_str!("presets/ds00-fig6a.toml")),
    ("ds00-fig6b", include_str!("presets/ds00-fig6b.toml")),
    ("ds00-fig6c", include_str!("presets/ds00-fig6c.toml")),
    ("ds00-fig6d", include_str!("presets/ds00-fig6d.toml")),
    ("ds00-fig6e", include_str!("presets/ds00-fig6e.toml")),
    ("ds00-fig6f", include_str!("presets/ds00-fig6f.toml")),
    ("coloured-pens", include_str!("presets/coloured-pens.toml")),
    (
        "crown-hatching",
        include_str!("presets/crown-hatching.toml"),
    ),
    (
        "lenient-sketch",
        include_str!("presets/lenient-sketch.toml"),
    ),
    ("plotter-a4", include_str!("presets/plotter-a4.toml")),
];
