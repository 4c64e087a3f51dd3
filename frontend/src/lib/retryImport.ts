const PAUSE_MS = 1500;

/**
 * Loads the code of a page. While the server is not reachable the import is retried, so that the
 * page does not change; if the server responds without the code, the error is thrown, and the
 * router reloads the page, which was rebuilt.
 */
export function retryImport<Loaded>(load: () => Promise<Loaded>): () => Promise<Loaded> {
  return async () => {
    for (;;) {
      try {
        return await load();
      } catch (error) {
        if (await isReachable()) throw error;
        await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
      }
    }
  };
}

async function isReachable(): Promise<boolean> {
  try {
    return (await fetch("/api/v1/health")).ok;
  } catch {
    return false;
  }
}
