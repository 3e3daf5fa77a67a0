// The Transformer Task Planner: reads demonstrations, then decides (ttp/network.py,
// ttp/compact_network.py and ttp/modeling_ttp.py).

class TTP {
  /** Take a policy as policy_data.py packs it. */
  constructor({ weights: base64, heads, encoderLayers, decoderLayers, dimTime }) {
    const all = readSafetensors(bytesOf(base64));
    const weights = weightsOf(all, "network");
    const layers = (kind, count, Kind) => Array.from({ length: count },
      (_, i) => new Kind(weightsOf(weights, `${kind}.${i}`), heads));
    this.instances = new InstanceEncoder(weightsOf(weights, "instances"), dimTime);
    this.encoder = layers("encoder", encoderLayers, EncoderLayer);
    this.encoderNorm = weightsOf(weights, "encoder_norm");
    this.decoder = layers("decoder", decoderLayers, DecoderLayer);
    this.decoderNorm = weightsOf(weights, "decoder_norm");
    this.pointer = weightsOf(weights, "pointer");
    this.failures = weightsOf(weights, "failures");
    this.collisions = new CollisionModel(weightsOf(weights, "clashes"));
    const places = all["recognition.places"];
    this.denoiser = places ? new Denoiser(places) : null;
  }

  // Reading demonstrations ------------------------------------------------------------------------

  /** Read demonstrations, { session, decisions } each; several are weighed alike. */
  readPrompts(demonstrations) {
    return demonstrations.map((demonstration) => this.encode(chosenRows(demonstration)));
  }

  /** psi = f_te . f_e, as each layer of f_td remembers it. */
  encode(rows) {
    const tokens = this.encoder.reduce((one, layer) => layer.transform(one),
      { features: this.instances.embed(rows), rows });
    const prompt = { features: layerNorm(this.encoderNorm, tokens.features), rows };
    return this.decoder.map((layer) => layer.crossAttention.remember(prompt));
  }

  // Deciding --------------------------------------------------------------------------------------

  /** Begin an episode by the demonstrations that were read. */
  begin(context) {
    return { context, failed: new FailedChoices() };
  }

  /**
   * Choose an instance of an observation.
   *
   * Returns the instance; the log-probability of each row, -Infinity where it may not be chosen;
   * and for each demonstration how much the decision attends to each of its decisions.
   */
  decide({ context, failed }, observation) {
    const rows = this.denoiser ? this.denoiser.denoise(observation.rows) : observation.rows;
    const situation = this.situation(rows, failed.find(rows));
    const read = context.map((prompt) => this.score(situation, prompt));
    const scores = rows.map(() => -Infinity);
    situation.candidates.forEach((row, i) => {
      scores[row] = read.reduce((sum, one) => sum + one.scores[i], 0) / read.length;
    });
    const choice = scores.indexOf(Math.max(...scores));
    failed.record(rows[choice]);
    const attention = read.map((one) => one.attention);
    return { instance: observation.ids[choice], scores, attention };
  }

  /** What every prompt is asked about: the rows that may be chosen, as tokens, then ACT. */
  situation(rows, failed) {
    const timeless = rows.map((row) => row.slice().fill(0, DECISION, DECISION + 1));
    const candidates = choosable(timeless);
    const attended = [...candidates.map((i) => timeless[i]), new Float32Array(COLUMNS)];
    const features = this.instances.embed(attended);
    const failedTokens = candidates.flatMap((row, i) => (failed.has(row) ? [i] : []));
    for (const i of failedTokens) addTo(rowOf(features, i), this.failures.marker.values);
    const logFree = this.collisions.logFree(timeless);
    return {
      candidates,
      tokens: { features, rows: attended },
      failedTokens,
      logFree: candidates.map((i) => logFree[i]),
    };
  }

  /** pi = f_td . f_e, and the pointer. */
  score({ tokens, failedTokens, logFree }, prompt) {
    const { outputs, attention } = this.transform(tokens, prompt);
    const free = fall(this.point(outputs), logFree.map((one) => 1 - Math.exp(one)))
      .map((score, i) => score + logFree[i]);
    const penalties = free.map((_, i) => (failedTokens.includes(i) ? this.penalty(outputs, i) : 0));
    return { scores: logSoftmax(fall(free, penalties)), attention };
  }

  /** f_td: the outputs, and the ACT token's attention to the prompt, the mean of the layers'. */
  transform(tokens, prompt) {
    const attention = new Float32Array(prompt[0].rows.length);
    const outputs = this.decoder.reduce((one, layer, i) => {
      const transformed = layer.transform(one, prompt[i]);
      transformed.ofLast.forEach((weight, j) => { attention[j] += weight / this.decoder.length; });
      return transformed.tokens;
    }, tokens);
    return { outputs: layerNorm(this.decoderNorm, outputs.features), attention };
  }

  /** The scores of all tokens but the last, ACT, whose query they answer. */
  point(outputs) {
    const act = matrixOf([rowOf(outputs, outputs.rows - 1)]);
    const query = linear(weightsOf(this.pointer, "query"), act).values;
    const keys = linear(weightsOf(this.pointer, "key"), outputs);
    const scale = 1 / Math.sqrt(outputs.columns);
    return Array.from({ length: outputs.rows - 1 },
      (_, i) => product(query, rowOf(keys, i)) * scale);
  }

  /** How far the score of a failed choice falls, from 0 to 1. */
  penalty(outputs, i) {
    const { values } = this.failures["gate.weight"];
    return sigmoid(product(values, rowOf(outputs, i)) + this.failures["gate.bias"].values[0]);
  }
}

/** Move scores towards the lowest one, as far as fractions say (common/score_correction.py). */
function fall(scores, fractions) {
  const lowest = Math.min(...scores) - 1;
  return scores.map((score, i) => score + fractions[i] * (lowest - score));
}

/** A demonstration's tokens: the row that each decision chose (ttp/prompt_tokens.py). */
function chosenRows({ session, decisions }) {
  const state = kitchenAtStart(session);
  return decisions.map((instance, decision) => {
    const { rows, ids } = observe(state, session, decision);
    const reason = decide(state, instance);
    if (reason !== "") throw new Error(`Decision ${decision} of a demonstration: ${reason}`);
    return rows[ids.indexOf(instance)];
  });
}
