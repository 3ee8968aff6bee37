// Commands: one Idempotency-Key per press of a button, the same one for its retries, so that a retry never acts twice.

export type Command = 'start' | 'stop' | 'reset';
export interface Refusal {
  text: string;
  remedies: string[];
}

/** A Start that arrives seconds after the press would surprise whoever stands at the arm; a Stop never comes too late. */
const kTries: Record<Command, number> = { start: 1, stop: 3, reset: 1 };
const kAnswerMs = 4000;

/** 128 random bits; crypto.randomUUID does not exist on plain HTTP. */
export function newKey(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (b) => b.toString(16).padStart(2, '0')).join('');
}

/** Null when the cell accepted. A Stop that got no answer is tried again at once; refusals are not. */
export async function command(name: Command, unreachable: string): Promise<Refusal | null> {
  const key = newKey();
  for (let i = 0; i < kTries[name]; ++i) {
    const abort = new AbortController();
    const timer = setTimeout(() => abort.abort(), kAnswerMs);
    try {
      const reply = await fetch(`/api/v1/${name}`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/json', 'Idempotency-Key': key },
        body: '{}',
        signal: abort.signal,
      });
      return refusalOf(await reply.json());
    } catch {
      // no answer: the next try carries the same key
    } finally {
      clearTimeout(timer);
    }
  }
  return { text: unreachable, remedies: [] };
}

function refusalOf(body: unknown): Refusal | null {
  const reply = body as { ok?: unknown; error?: { text?: unknown; remedies?: unknown } } | null;
  if (reply?.ok === true) return null;
  const remedies = reply?.error?.remedies;
  return { text: String(reply?.error?.text ?? '?'), remedies: Array.isArray(remedies) ? remedies.map(String) : [] };
}
