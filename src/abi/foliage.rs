//! What the kernels of `foliage` share with Rust.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Values that one invocation of the scan adds up.
        SCAN_CHUNK: u32 = 256;
        /// Numbers that one invocation of the radix sort moves.
        RADIX_BLOCK: u32 = 64;
        /// Bits of one digit of the radix sort.
        RADIX_BITS: u32 = 6;
        /// Invocations that share one tile of nodes or block of queries; each takes every
        /// `FIELD_SLOTS`-th generator.
        FIELD_SLOTS: u32 = 8;
        /// Nodes of a tile along each axis of the density grid.
        TILE_SIDE: u32 = 4;
        /// Nodes of a tile.
        TILE_NODES: u32 = 64;
        /// Queries of a block of the field kernel.
        BLOCK_QUERIES: u32 = 32;
        /// Invocations of a group of the field kernel: as many as 16 KiB of shared memory hold.
        FIELD_GROUP: u32 = 32;
        /// What the field kernel adds up: the density.
        FIELD_DENSITY: u32 = 0;
        /// The gradient, without the density.
        FIELD_GRADIENT: u32 = 1;
        /// Both.
        FIELD_BOTH: u32 = 2;
        /// Bits of a generator's index that select its column in the generator image.
        GENERATOR_COLUMN_BITS: u32 = 10;
        /// Culling is this much wider than the support, against rounding of bins.
        CULL_MARGIN: f32 = 1e-5;
        /// Vector norms of equation 2, in the order of `foliage::Norm`.
        NORM_EUCLIDEAN: u32 = 0;
        /// L1.
        NORM_MANHATTAN: u32 = 1;
        /// L-infinity.
        NORM_MAXIMUM: u32 = 2;
        /// Invocations that sweep one direction of the skylight.
        SKY_GROUP: u32 = 256;
        /// `directions.comp`: direction of one gradient.
        DIRECTIONS_SINGLE: u32 = 0;
        /// `directions.comp`: mean of the directions of two gradients.
        DIRECTIONS_MEAN: u32 = 1;
        /// `directions.comp`: keeps the directions there are and fills the gaps.
        DIRECTIONS_FILL: u32 = 2;
        /// Smallest ambient coefficient of the length encoding, 1 / 255.
        SMALLEST_AMBIENT: f32 = 0.003921569;
        /// Encodings, in the order of `foliage::Encoding`.
        ENCODING_LENGTH: u32 = 0;
        /// Octahedral 2 x snorm16 + unorm16.
        ENCODING_PACKED16: u32 = 1;
        /// Octahedral 2 x snorm8 + unorm8.
        ENCODING_PACKED8: u32 = 2;
        /// Items or boxes in one box of the hierarchy over the implicit surface.
        BOX_CHILDREN: u32 = 8;
        /// Neighbouring queries that one invocation of `nearest.comp` takes at once, of triangles:
        /// their code is long, and drivers take seconds to compile it for more.
        NEAREST_FACE_QUERIES: u32 = 8;
        /// Neighbouring queries that one invocation of `nearest.comp` takes at once, of vertices.
        NEAREST_QUERIES: u32 = 32;
        /// Generators that `exact.comp` adds in one round of its loop.
        EXACT_BATCH: u32 = 8;
        /// Rounds of the loop over generators in one turn of `exact.comp`.
        EXACT_ROUNDS: u32 = 768;
        /// Turns of one dispatch of `exact.comp`; with their rounds well below 65,535.
        EXACT_TURNS: u32 = 64;
        /// `ExactState::phase`: on the way onto the surface for the first time.
        EXACT_START: u32 = 0;
        /// There, the gradient is wanted.
        EXACT_START_FOUND: u32 = 1;
        /// On the way back onto the surface after a step along it.
        EXACT_SEEK: u32 = 2;
        /// There, the gradient is wanted.
        EXACT_SEEK_FOUND: u32 = 3;
        /// Nothing is left to do.
        EXACT_DONE: u32 = 4;
        /// Bits of the lattice on which voxels of subsets are laid.
        SUBSET_LATTICE_BITS: u32 = 20;
        /// Bits behind the point of positions while they are summed.
        SUBSET_POSITION_BITS: u32 = 24;
        /// Units of an area's high word per squared diagonal; the low word holds what is behind
        /// the point.
        SUBSET_AREA_HIGH: f32 = 4096.0;
        /// Words of the sums of one voxel: three positions and the area of two each, the count.
        SUBSET_SUM_WORDS: u32 = 9;
        /// No generator.
        SUBSET_NONE: u32 = 0xffff_ffff;
        /// Places of the hash table that are looked at for one generator; the table is at most
        /// half full.
        SUBSET_PROBES: u32 = 4096;
        /// Newton steps onto the surface at most (`exact.comp`).
        EXACT_NEWTON_STEPS: u32 = 20;
        /// Descent steps along the surface at most (`exact.comp`).
        EXACT_DESCENT_STEPS: u32 = 200;
        /// Steps shorter than this share of the radius have arrived (`exact.comp`).
        EXACT_TOLERANCE: f32 = 1e-5;
        /// Below this |grad D| times the radius a Newton step leads nowhere (`exact.comp`).
        EXACT_SLOPE_FLOOR: f32 = 1e-6;
        /// Below this |grad D| times the radius the gradient has no direction.
        GRADIENT_FLOOR: f32 = 1e-3;
        /// Below this length a mean of unit vectors has no direction.
        OPPOSITE_FLOOR: f32 = 1e-3;
    }
    structs {
        /// Push constants of the kernels that walk the grid (`foliage/surface_*.comp`,
        /// `foliage/sample.comp`).
        SurfaceGrid {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Threshold; inside is strictly above.
            tau: f32,
            /// Vertices of the surface (`surface_normals.comp`) or points (`sample.comp`).
            count: u32,
            /// Radius of influence (`surface_normals.comp`).
            radius: f32,
        }

        /// Push constants of kernels that need to know only how many there are.
        Count {
            /// Items.
            count: u32,
        }

        /// Push constants of `foliage/surface_boxes.comp`.
        BoxLevel {
            /// Boxes of this level.
            count: u32,
            /// Items or boxes of the level below.
            children: u32,
            /// 0: over items.
            level: u32,
            /// First box of this level.
            first: u32,
            /// First box of the level below.
            child_first: u32,
        }

        /// Push constants of `foliage/nearest.comp`.
        NearestQueries {
            /// Queries.
            count: u32,
            /// Items in the hierarchy.
            items: u32,
            /// Levels of boxes.
            levels: u32,
            /// Level whose boxes this dispatch walks, counted from 1.
            root_level: u32,
            /// First of these boxes.
            root_first: u32,
            /// The box after the last.
            root_last: u32,
            /// Whether an earlier dispatch has left something in the result.
            continues: u32,
        }

        /// Push constants of `foliage/exact.comp`.
        ExactQueries {
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Queries.
            count: u32,
            /// Threshold.
            tau: f32,
            /// Whether an earlier dispatch has left states to go on from.
            continues: u32,
        }

        /// Where `foliage/exact.comp` stands with one query between two dispatches.
        ExactState {
            /// Density and, without its common factor, gradient of the generators so far.
            sum: [f32; 4],
            /// Where they are summed.
            point: [f32; 3],
            /// Share of the tangential way that is tried.
            step: f32,
            /// Nearest point of the surface so far.
            best: [f32; 3],
            /// Gradient there.
            gradient: [f32; 3],
            /// `EXACT_*`.
            phase: u32,
            /// Newton steps since the last descent.
            newton_steps: u32,
            /// Descents so far.
            descent_steps: u32,
            /// Row of bins that the sum has come to.
            row: u32,
            /// Generator of it that comes next.
            next: u32,
        }

        /// Push constants of `foliage/scan_sums.comp` and `foliage/scan_apply.comp`.
        Scan {
            /// Values to add up.
            count: u32,
            /// Whether `scan_apply` adds the scanned chunk sums of `bases`.
            has_bases: u32,
        }

        /// One digit of the stable radix sort.
        Radix {
            /// Numbers.
            count: u32,
            /// Blocks of `RADIX_BLOCK` numbers.
            blocks: u32,
            /// Lowest bit of the digit; 0: the numbers are still in their own order.
            shift: u32,
        }

        /// Push constants of the kernels that sort points into bins.
        BinPoints {
            /// Corner of bin (0,0,0).
            origin: [f32; 3],
            /// 1 / edge of a bin.
            inverse_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Points.
            count: u32,
            /// 0: bins in rows, x fastest; 1: bins in Morton order.
            morton: u32,
            /// 0: generators weigh what they stand for; otherwise their area times this.
            area_scale: f32,
        }

        /// Push constants of `foliage/density.comp`.
        DensityGrid {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
        }

        /// Push constants of `foliage/sky_depth.comp`.
        SkyDepth {
            /// Nodes per axis of the leaf-area grid.
            nodes: [u32; 3],
            /// Cell size.
            cell: f32,
            /// First direction of the batch.
            first: u32,
            /// Directions of the batch: groups of `SKY_GROUP` invocations.
            count: u32,
        }

        /// Push constants of `foliage/sky_light.comp`.
        SkyLight {
            /// Nodes.
            node_count: u32,
            /// First direction of the batch; 0 starts the sum.
            first: u32,
            /// Directions of the batch.
            count: u32,
            /// 1 / all directions.
            share: f32,
            /// Extinction per leaf area: 0.5 for leaves at random angles.
            extinction: f32,
            /// Cell size.
            cell: f32,
        }

        /// Push constants of `foliage/sky_gather.comp`.
        SkyGather {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Points.
            count: u32,
        }

        /// Push constants of `foliage/field.comp`.
        FieldQueries {
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Queries.
            count: u32,
        }

        /// Push constants of `foliage/directions.comp`.
        GradientDirections {
            /// Queries.
            count: u32,
            /// Radius of the first field.
            radius: f32,
            /// Radius of the second field.
            wide_radius: f32,
        }

        /// Push constants of `foliage/realign.comp`.
        Realign {
            /// Vertices.
            count: u32,
            /// Share of the realigned normal.
            blend: f32,
        }

        /// Push constants of `foliage/ambient.comp` (Luft, Balzer, Deussen 2007, equation 4).
        AmbientTransfer {
            /// Vertices.
            count: u32,
            /// Threshold, subtracted from the density.
            tau: f32,
            /// Smallest coefficient.
            k_min: f32,
            /// Density (beyond the threshold) from which on it is `k_min`.
            d_min: f32,
            /// Exponent n.
            exponent: f32,
        }

        /// The search for the size of voxels (`foliage/subset_voxels.comp`), by halving.
        SubsetSearch {
            /// Smallest size that may do.
            low: u32,
            /// Smallest size that is known to do.
            high: u32,
            /// Voxels of the size in between.
            voxels: u32,
            /// Generators for which the table had no place.
            lost: u32,
        }

        /// Push constants of `foliage/subset_voxels.comp`.
        SubsetVoxels {
            /// Generators.
            count: u32,
            /// Places of the hash table, a power of two, less one.
            table_mask: u32,
            /// Where the voxels begin, in 1/2048 of their edge.
            shift: [u32; 3],
        }

        /// Push constants of `foliage/subset_draw.comp`.
        SubsetDraw {
            /// Generators.
            count: u32,
            /// `pcg` of the seed.
            hashed_seed: u32,
            /// Numbers below it are kept.
            threshold: u32,
        }

        /// Push constants of `foliage/subset_emit.comp`.
        SubsetEmit {
            /// Generators.
            count: u32,
            /// How many each that is kept stands for.
            scale: f32,
        }
    }
}
