import { answerOf, api } from "./client";
import type { Api } from "./types";

/** What the sign-in page shows; the program answers it to anybody. */
export const readSignInPage = () => answerOf(api.GET("/api/sign-in"));

export const readSession = () => answerOf(api.GET("/api/session"));

export const beginSession = (body: Api<"SignIn">) => answerOf(api.POST("/api/session", { body }));

export const endSession = () => answerOf(api.DELETE("/api/session"));
