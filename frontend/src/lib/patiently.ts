const PAUSE_MS = 1500;

/**
 * The code of a page. Where the server is lost it is asked for again until it comes, so that the
 * page stays as it is; where the server is there and the code is not, the error goes on, and the
 * router loads the page anew, for it was built anew.
 */
export function patiently<Loaded>(load: () => Promise<Loaded>): () => Promise<Loaded> {
  return async () => {
    for (;;) {
      try {
        return await load();
      } catch (error) {
        if (await answers()) throw error;
        await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
      }
    }
  };
}

async function answers(): Promise<boolean> {
  try {
    return (await fetch("/api/v1/health")).ok;
  } catch {
    return false;
  }
}
