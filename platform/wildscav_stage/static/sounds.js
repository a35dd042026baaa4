// Sounds, made of noise and tones: there are no files to load.

export class Sounds {
  constructor() {
    this.on = true;
  }

  // Browsers allow sound only once somebody has clicked.
  unlock() {
    this.context ??= new AudioContext();
    this.context.resume();
    this.noise ??= this.#makeNoise();
  }

  #makeNoise() {
    const buffer = this.context.createBuffer(1, this.context.sampleRate / 2, this.context.sampleRate);
    const samples = buffer.getChannelData(0);
    for (let index = 0; index < samples.length; index += 1) samples[index] = Math.random() * 2 - 1;
    return buffer;
  }

  #fading(volume, seconds) {
    const gain = this.context.createGain();
    const now = this.context.currentTime;
    gain.gain.setValueAtTime(volume, now);
    gain.gain.exponentialRampToValueAtTime(0.0001, now + seconds);
    gain.connect(this.context.destination);
    return gain;
  }

  #burst(frequency, volume, seconds) {
    const source = this.context.createBufferSource();
    const filter = this.context.createBiquadFilter();
    source.buffer = this.noise;
    filter.type = "lowpass";
    filter.frequency.value = frequency;
    source.connect(filter).connect(this.#fading(volume, seconds));
    source.start();
    source.stop(this.context.currentTime + seconds);
  }

  #tone(from, to, volume, seconds, delay = 0) {
    const tone = this.context.createOscillator();
    const start = this.context.currentTime + delay;
    tone.frequency.setValueAtTime(from, start);
    tone.frequency.exponentialRampToValueAtTime(to, start + seconds);
    tone.connect(this.#fading(volume, seconds + delay));
    tone.start(start);
    tone.stop(start + seconds);
  }

  // Play what happened since the last picture.
  play({ fired, hits, hurt, gained }) {
    if (!this.on || !this.context) return;
    if (fired) this.#burst(1800, 0.35, 0.16);
    if (hits) this.#tone(1500, 900, 0.2, 0.08);
    if (hurt) this.#burst(300, 0.6, 0.25);
    if (gained) [660, 880].forEach((tone, index) => this.#tone(tone, tone * 1.01, 0.15, 0.12, index * 0.09));
  }

  playTick() {
    if (this.on && this.context) this.#tone(440, 440, 0.12, 0.1);
  }

  playEnd() {
    if (!this.on || !this.context) return;
    [523, 659, 784].forEach((tone, index) => this.#tone(tone, tone, 0.15, 0.25, index * 0.16));
  }
}
