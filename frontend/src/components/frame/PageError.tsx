import { useRouter } from "@tanstack/react-router";
import { ProblemAlert } from "../display/ProblemAlert";

/** Error of a page, shown inside the frame. */
export function PageError({ error, reset }: { error: unknown; reset?: () => void }) {
  const router = useRouter();
  return (
    <ProblemAlert
      error={error}
      onRetry={() => {
        reset?.();
        void router.invalidate();
      }}
    />
  );
}
