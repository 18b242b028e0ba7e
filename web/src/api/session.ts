import { answerOf, api } from "./client";
import type { Api } from "./types";

/** Content of the sign-in page; needs no session. */
export const readSignInPage = () => answerOf(api.GET("/api/sign-in"));

export const readSession = () => answerOf(api.GET("/api/session"));

export const beginSession = (body: Api<"SignIn">) => answerOf(api.POST("/api/session", { body }));

export const putPassword = (body: Api<"PasswordChange">) =>
  answerOf(api.PUT("/api/session/password", { body }));

export const endSession = () => answerOf(api.DELETE("/api/session"));
