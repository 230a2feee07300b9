//! What differs over a leaf: factor on the diffuse reflectance, thickness, gloss and roughness.
//!
//! The paper stores a side in two RGBA textures: `gamma.rgb + delta.a` and `rho_s.rgb + m.a`.

use super::appearance::Texel;

/// The two textures of one side, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct SideMaps {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// gamma in RGB (>= 0, may exceed 1); in A the deviation of the thickness over the thickness
    /// (>= -1).
    pub gamma_delta: Vec<[f32; 4]>,
    /// Intensity of the gloss in RGB, \[0, 1\]; m in A, (0, 1].
    pub specular: Vec<[f32; 4]>,
}

impl SideMaps {
    /// Maps that say nothing: gamma 1, no deviation, one gloss.
    #[must_use]
    pub fn plain(size: [u32; 2], rho_s: f32, m: f32) -> Self {
        let count = size[0] as usize * size[1] as usize;
        Self {
            size,
            gamma_delta: vec![[1.0, 1.0, 1.0, 0.0]; count],
            specular: vec![[rho_s, rho_s, rho_s, m]; count],
        }
    }

    /// Texels.
    #[must_use]
    pub fn len(&self) -> usize {
        self.gamma_delta.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.gamma_delta.is_empty()
    }

    /// One texel.
    #[must_use]
    pub fn texel(&self, index: usize) -> Texel {
        let [r, g, b, delta] = self.gamma_delta[index];
        let [sr, sg, sb, m] = self.specular[index];
        Texel {
            gamma: [r, g, b],
            delta,
            rho_s: [sr, sg, sb],
            m,
        }
    }

    /// Refuses maps whose sizes differ and values that mean nothing; says what is wrong.
    pub(super) fn check(&self) -> Result<(), String> {
        let [w, h] = self.size;
        let count = w as usize * h as usize;
        if count == 0 || self.gamma_delta.len() != count || self.specular.len() != count {
            return Err(format!(
                "maps of {w}x{h} have {} and {} texels",
                self.gamma_delta.len(),
                self.specular.len()
            ));
        }
        let place = |i: usize| format!("at column {}, row {}", i % w as usize, i / w as usize);
        for (i, t) in self.gamma_delta.iter().enumerate() {
            if !t[..3].iter().all(|g| *g >= 0.0 && g.is_finite()) {
                return Err(format!("gamma {:?} {} is not >= 0", &t[..3], place(i)));
            }
            if !(t[3] >= -1.0 && t[3].is_finite()) {
                return Err(format!(
                    "thickness deviation {} {} is below -1",
                    t[3],
                    place(i)
                ));
            }
        }
        for (i, t) in self.specular.iter().enumerate() {
            if !t[..3].iter().all(|s| (0.0..=1.0).contains(s)) {
                return Err(format!(
                    "rho_s {:?} {} is outside [0, 1]",
                    &t[..3],
                    place(i)
                ));
            }
            if !(t[3] > 0.0 && t[3] <= 1.0) {
                return Err(format!("roughness {} {} is outside (0, 1]", t[3], place(i)));
            }
        }
        Ok(())
    }
}
