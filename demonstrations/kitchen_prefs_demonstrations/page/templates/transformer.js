// The layers of f_te and f_td: pre-norm, with geometric attention (ttp/transformer.py and
// ttp/compact_network.py). Tokens are { features, rows }: a matrix and the rows of the instances,
// zeros for the ACT token.

const GEOMETRY_UNITS = [1000, 1000, 10]; // of a and b in 1 / m^2, and of c
const GEOMETRY_SIZE = 9; // by so much Python lengthens queries and keys, whose scores it divides

const GEOMETRY_TERMS = 3; // of each pair

const dot3 = (a, b, from) =>
  a[from] * b[from] + a[from + 1] * b[from + 1] + a[from + 2] * b[from + 2];
const isInstance = (row) => row.subarray(EXTENTS, QUATERNION).some((value) => value !== 0);

/**
 * How alike in size and how near the instances of two sets are, and whether the second is an
 * object; terms of the first alone drop out of a softmax. The ACT token is like nothing.
 */
function geometryOf(rows, others) {
  const terms = new Float64Array(rows.length * others.length * GEOMETRY_TERMS);
  rows.forEach((row, i) => {
    if (!isInstance(row)) return;
    others.forEach((other, j) => {
      const at = (i * others.length + j) * GEOMETRY_TERMS;
      terms[at] = 2 * dot3(row, other, EXTENTS) - dot3(other, other, EXTENTS);
      terms[at + 1] = 2 * dot3(row, other, POSITION) - dot3(other, other, POSITION);
      terms[at + 2] = other[IS_OBJECT];
    });
  });
  return terms;
}

/** Attention that prefers instances of similar size, nearby instances, and objects. */
class GeometricAttention {
  constructor(weights, heads) {
    this.query = weightsOf(weights, "query");
    this.keyValue = weightsOf(weights, "key_value");
    this.output = weightsOf(weights, "output");
    this.geometric = [...weights["geometric_scores.weights"].values]
      .map((weight, i) => weight * GEOMETRY_UNITS[i % 3]); // a, b, c of each head
    this.heads = heads;
  }

  /** What is attended to, projected once for all that attends to it. */
  remember(memory) {
    return { keyValue: linear(this.keyValue, memory.features), rows: memory.rows };
  }

  /** The attended values, and how much the last token attends to each of the memory's. */
  attend(tokens, { keyValue, rows }) {
    const queries = linear(this.query, tokens.features);
    const geometry = geometryOf(tokens.rows, rows);
    const attended = matrix(queries.rows, queries.columns);
    const ofLast = new Float32Array(rows.length);
    for (let head = 0; head < this.heads; head += 1) {
      for (let i = 0; i < queries.rows; i += 1) {
        const weights = softmax(this.scores(head, rowOf(queries, i), keyValue,
          geometry.subarray(i * rows.length * GEOMETRY_TERMS)));
        this.gather(head, weights, keyValue, rowOf(attended, i));
        if (i === queries.rows - 1) weights.forEach((one, j) => { ofLast[j] += one / this.heads; });
      }
    }
    return { values: linear(this.output, attended), ofLast };
  }

  scores(head, query, keyValue, geometry) {
    const [a, b, c] = this.geometric.slice(3 * head, 3 * head + 3);
    const size = query.length / this.heads;
    const scale = 1 / Math.sqrt(size + GEOMETRY_SIZE);
    const scores = new Float64Array(keyValue.rows);
    for (let j = 0; j < keyValue.rows; j += 1) {
      const from = j * keyValue.columns + head * size;
      let similarity = 0;
      for (let k = 0; k < size; k += 1) {
        similarity += query[head * size + k] * keyValue.values[from + k];
      }
      const at = j * GEOMETRY_TERMS;
      scores[j] = similarity * scale
        + a * geometry[at] + b * geometry[at + 1] + c * geometry[at + 2];
    }
    return scores;
  }

  /** Add up the values of a head; keys are the first half of each row, values the second. */
  gather(head, weights, keyValue, attended) {
    const size = attended.length / this.heads;
    for (let j = 0; j < weights.length; j += 1) {
      const weight = weights[j];
      const from = j * keyValue.columns + attended.length + head * size;
      for (let k = 0; k < size; k += 1) {
        attended[head * size + k] += weight * keyValue.values[from + k];
      }
    }
  }
}

/** What the layers of encoder and decoder have in common: normalised inputs, and sums. */
class Layer {
  constructor(weights, heads) {
    this.attention = new GeometricAttention(weightsOf(weights, "attention"), heads);
    this.feedforward = [0, 2].map((i) => weightsOf(weights, `feedforward.${i}`));
    this.norms = [0, 1, 2].map((i) => weightsOf(weights, `residuals.${i}.norm`));
  }

  attendToThemselves({ features, rows }) {
    const normalised = { features: layerNorm(this.norms[0], features), rows };
    const { values } = this.attention.attend(normalised, this.attention.remember(normalised));
    return { features: sumOf(features, values), rows };
  }

  feed({ features, rows }, norm) {
    const [first, second] = this.feedforward;
    const hidden = mapped(linear(first, layerNorm(norm, features)), relu);
    return { features: sumOf(features, linear(second, hidden)), rows };
  }
}

/** A layer of f_te: self-attention and a feed-forward network. */
class EncoderLayer extends Layer {
  transform(tokens) {
    return this.feed(this.attendToThemselves(tokens), this.norms[1]);
  }
}

/** A layer of f_td: self-attention, cross-attention to the prompt, and a feed-forward network. */
class DecoderLayer extends Layer {
  constructor(weights, heads) {
    super(weights, heads);
    this.crossAttention = new GeometricAttention(weightsOf(weights, "cross_attention"), heads);
  }

  /** The tokens, transformed, and how much the last one attends to each token of the prompt. */
  transform(tokens, prompt) {
    const { features, rows } = this.attendToThemselves(tokens);
    const normalised = { features: layerNorm(this.norms[1], features), rows };
    const { values, ofLast } = this.crossAttention.attend(normalised, prompt);
    const summed = { features: sumOf(features, values), rows };
    return { tokens: this.feed(summed, this.norms[2]), ofLast };
  }
}
