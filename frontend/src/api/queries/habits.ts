/** How a long list is read page by page. */
import { keepPreviousData } from "@tanstack/react-query";

/** Options of a list that is read on from where the last page ended. */
export const PAGED = {
  initialPageParam: undefined as string | undefined,
  getNextPageParam: (page: { next?: string | null }) => page.next ?? undefined,
  placeholderData: keepPreviousData,
};
