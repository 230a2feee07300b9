//! What an interrupted precomputation leaves behind.

use serde::{Deserialize, Serialize};

use super::prt::Snapshot;

const MAGIC: &[u8; 8] = b"umbrCKP\n";

/// The work done so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Hash of the model and of every setting that the result depends on.
    pub job: [u8; 32],
    /// Transfer vectors so far.
    pub transfer: Snapshot,
    /// Levels of detail of those that are done.
    pub levels: Vec<f32>,
    /// Transfer matrices so far.
    pub matrices: Snapshot,
    /// Those that are done, as they are stored.
    pub packed: Vec<f32>,
    /// Visibility maps so far, as runs.
    pub maps: Vec<Vec<u8>>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    transfer: Part,
    levels: usize,
    matrices: Part,
    packed: usize,
    maps: Vec<usize>,
}

/// The numbers of a [`Snapshot`].
#[derive(Serialize, Deserialize)]
struct Part {
    receivers: u32,
    sample: u32,
    values: usize,
    sums: usize,
}

impl From<&Snapshot> for Part {
    fn from(snapshot: &Snapshot) -> Self {
        Self {
            receivers: snapshot.receivers,
            sample: snapshot.sample,
            values: snapshot.values.len(),
            sums: snapshot.sums.len(),
        }
    }
}

/// The bytes of the file.
#[must_use]
pub fn encode(checkpoint: &Checkpoint) -> Vec<u8> {
    let header = Header {
        transfer: Part::from(&checkpoint.transfer),
        levels: checkpoint.levels.len(),
        matrices: Part::from(&checkpoint.matrices),
        packed: checkpoint.packed.len(),
        maps: checkpoint.maps.iter().map(Vec::len).collect(),
    };
    let header = serde_json::to_vec(&header).expect("plain data");
    let mut out = MAGIC.to_vec();
    out.extend(checkpoint.job);
    out.extend((header.len() as u64).to_le_bytes());
    out.extend(header);
    let (transfer, matrices) = (&checkpoint.transfer, &checkpoint.matrices);
    for floats in [
        &checkpoint.levels,
        &transfer.values,
        &transfer.sums,
        &matrices.values,
        &matrices.sums,
        &checkpoint.packed,
    ] {
        out.extend(bytemuck::cast_slice::<f32, u8>(floats));
    }
    out.extend(checkpoint.maps.iter().flatten());
    let sum = blake3::hash(&out);
    out.extend(sum.as_bytes());
    out
}

/// The checkpoint of `job` in `bytes`, or why there is none.
///
/// # Errors
/// Damage, or another job.
pub fn decode(bytes: &[u8], job: &[u8; 32]) -> Result<Checkpoint, &'static str> {
    const DAMAGED: &str = "what the interrupted run left is damaged";
    let (content, sum) = bytes.split_last_chunk::<32>().ok_or(DAMAGED)?;
    if !content.starts_with(MAGIC) || blake3::hash(content).as_bytes() != sum {
        return Err(DAMAGED);
    }
    let rest = &content[MAGIC.len()..];
    let (found, rest) = rest.split_first_chunk::<32>().ok_or(DAMAGED)?;
    if found != job {
        return Err("the interrupted run had another model or other settings");
    }
    let (length, rest) = rest.split_first_chunk::<8>().ok_or(DAMAGED)?;
    let length = u64::from_le_bytes(*length) as usize;
    let header = rest.get(..length).ok_or(DAMAGED)?;
    let header: Header = serde_json::from_slice(header).map_err(|_| DAMAGED)?;
    let mut rest = &rest[length..];
    let mut take = |count: usize| {
        let (block, after) = rest.split_at_checked(count).ok_or(DAMAGED)?;
        rest = after;
        Ok::<_, &'static str>(block)
    };
    let mut floats = |count: usize| {
        let block = take(count.checked_mul(4).ok_or(DAMAGED)?)?;
        Ok::<Vec<f32>, &'static str>(bytemuck::pod_collect_to_vec(block))
    };
    let levels = floats(header.levels)?;
    let mut snapshot = |part: &Part| {
        Ok::<_, &'static str>(Snapshot {
            receivers: part.receivers,
            values: floats(part.values)?,
            sample: part.sample,
            sums: floats(part.sums)?,
        })
    };
    let transfer = snapshot(&header.transfer)?;
    let matrices = snapshot(&header.matrices)?;
    let packed = floats(header.packed)?;
    let maps = header.maps.iter();
    let maps = maps
        .map(|&n| Ok::<_, &'static str>(take(n)?.to_vec()))
        .collect::<Result<_, _>>()?;
    Ok(Checkpoint {
        job: *job,
        transfer,
        levels,
        matrices,
        packed,
        maps,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_comes_back_for_its_own_job_only() {
        let checkpoint = Checkpoint {
            job: [3; 32],
            transfer: Snapshot {
                receivers: 5,
                values: vec![1.0, 2.0],
                sample: 7,
                sums: vec![0.5],
            },
            levels: vec![3.0, 4.0],
            matrices: Snapshot {
                receivers: 2,
                values: Vec::new(),
                sample: 1,
                sums: vec![8.0, 7.0],
            },
            packed: vec![6.0],
            maps: vec![vec![1, 2], vec![], vec![9]],
        };
        let bytes = encode(&checkpoint);
        assert_eq!(decode(&bytes, &[3; 32]).unwrap(), checkpoint);
        assert!(decode(&bytes, &[4; 32]).unwrap_err().contains("settings"));
        assert!(
            decode(&bytes[..50], &[3; 32])
                .unwrap_err()
                .contains("damaged")
        );
        assert!(decode(&[], &[3; 32]).is_err());
    }
}
